#include "studio/live_routes.hpp"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "live/live_json.hpp"
#include "studio/api.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

ordered_json setup_of(const Stage& stage) {
  if (!stage.is_live()) {
    return {{"source", nullptr},
            {"loaded", stage.is_loaded()},
            {"takes_files", stage.takes_files()},
            {"has_results", stage.has_results()}};
  }
  ordered_json setup = live::setup_json(stage.live());
  setup["loaded"] = stage.is_loaded();
  setup["session"] = stage.session_number();
  setup["takes_files"] = false;
  setup["has_results"] = false;
  return setup;
}

void set_up_looking(Api& api, Stage& stage) {
  api.on("GET /live", [&stage](const ApiRequest&) { return setup_of(stage); });
  api.on("GET /live/now", [&stage](const ApiRequest& asked) {
    const live::Live& live = stage.live();
    ordered_json now =
        live::moment_json(live.moment(asked.parameters.at("from").get<std::uint64_t>()), live);
    now["session"] = stage.session_number();
    return now;
  });
  api.on("GET /live/frozen", [&stage](const ApiRequest& asked) {
    const auto pixels = asked.parameters.at("pixels").get<std::size_t>();
    return json{{"charts", live::frozen_json(stage.live(), pixels)}};
  });
}

void set_up_bench(Api& api, Stage& stage) {
  api.on("POST /live/faults", [&stage](const ApiRequest& asked) {
    stage.live().add_fault(asked.body.at("kind").get<std::string>(),
                           asked.body.at("joint").get<int>(), asked.body.at("size").get<double>());
  });
  api.on("DELETE /live/faults", [&stage](const ApiRequest&) { stage.live().end_faults(); });
  api.on("POST /live/accommodation", [&stage](const ApiRequest& asked) {
    stage.live().set_accommodation(asked.body.at("on").get<bool>());
  });
  api.on("POST /live/again", [&stage](const ApiRequest&) { stage.live().begin_again(); });
}

void set_up_recordings(Api& api, Stage& stage) {
  api.on("POST /live/recording", [&stage](const ApiRequest&) { stage.live().start_recording(); });
  api.on("DELETE /live/recording", [&stage](const ApiRequest&) {
    return json{{"saved", stage.live().stop_recording()}};
  });
  api.on("POST /live/explanation",
         [&stage](const ApiRequest&) { return stage.explain_detection(); });
}

}  // namespace

void set_up_live_routes(Api& api, Stage& stage) {
  set_up_looking(api, stage);
  set_up_bench(api, stage);
  set_up_recordings(api, stage);
}

}  // namespace offnominal::desk::studio
