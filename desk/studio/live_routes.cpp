#include "studio/live_routes.hpp"

#include <cstdint>
#include <nlohmann/json.hpp>

#include "common/refused.hpp"
#include "live/live_json.hpp"
#include "studio/charts.hpp"
#include "studio/requests.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;
using nlohmann::ordered_json;

std::size_t pixels_of(const Request& request) {
  const auto pixels = number_of<std::size_t>(request, "pixels");
  if (pixels >= kFewestPixels && pixels <= kMostPixels) return pixels;
  throw Refused(Refused::Why::kBadRequest, "pixels has to be the width of a picture.");
}

// An action that has no answer of its own: what there is then.
template <typename Act>
void act(Response& response, const Act& do_it) {
  answer(response, [&] {
    do_it();
    return json::object();
  });
}

ordered_json setup_of(const Stage& stage) {
  if (!stage.is_live()) {
    return {{"source", nullptr},
            {"loaded", stage.is_loaded()},
            {"takes_files", stage.takes_files()},
            {"has_results", stage.has_results()}};
  }
  ordered_json setup = live::setup_json(stage.live());
  setup["loaded"] = stage.is_loaded();
  setup["takes_files"] = false;
  setup["has_results"] = false;
  return setup;
}

void set_up_looking(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Get(api + "live", [&stage](const Request&, Response& response) {
    answer(response, [&] { return setup_of(stage); });
  });
  server.Get(api + "live/now", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      const live::Live& live = stage.live();
      return live::moment_json(live.moment(number_of<std::uint64_t>(request, "from")), live);
    });
  });
  server.Get(api + "live/frozen", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      const live::Live& live = stage.live();
      return json{{"charts", live::frozen_json(live, pixels_of(request))}};
    });
  });
}

void set_up_bench(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Post(api + "live/faults", [&stage](const Request& request, Response& response) {
    act(response, [&] {
      const json body = body_of(request);
      stage.live().add_fault(body.at("kind").get<std::string>(), body.value("joint", 0),
                             body.value("size", 0.0));
    });
  });
  server.Delete(api + "live/faults", [&stage](const Request&, Response& response) {
    act(response, [&] { stage.live().end_faults(); });
  });
  server.Post(api + "live/accommodation", [&stage](const Request& request, Response& response) {
    act(response, [&] { stage.live().set_accommodation(body_of(request).at("on").get<bool>()); });
  });
  server.Post(api + "live/again", [&stage](const Request&, Response& response) {
    act(response, [&] { stage.live().begin_again(); });
  });
}

void set_up_recordings(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Post(api + "live/recording", [&stage](const Request&, Response& response) {
    act(response, [&] { stage.live().start_recording(); });
  });
  server.Delete(api + "live/recording", [&stage](const Request&, Response& response) {
    answer(response, [&] { return json{{"saved", stage.live().stop_recording()}}; });
  });
  server.Post(api + "live/explanation", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.explain_detection(); });
  });
}

}  // namespace

void set_up_live_routes(httplib::Server& server, const std::string& api, Stage& stage) {
  set_up_looking(server, api, stage);
  set_up_bench(server, api, stage);
  set_up_recordings(server, api, stage);
}

}  // namespace offnominal::desk::studio
