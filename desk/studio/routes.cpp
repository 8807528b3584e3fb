#include "studio/routes.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/refused.hpp"
#include "studio/assets.hpp"
#include "studio/live_routes.hpp"
#include "studio/load_routes.hpp"
#include "studio/requests.hpp"
#include "studio/results_routes.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;

// The part of the time that is shown, where the request names one.
template <typename Any>
void set_range(const Request& request, Any& view) {
  if (!request.has_param("from") || !request.has_param("to")) return;
  view.from_s = number_of<double>(request, "from");
  view.to_s = number_of<double>(request, "to");
  if (!std::isfinite(*view.from_s) || !std::isfinite(*view.to_s)) {
    throw Refused(Refused::Why::kBadRequest, "from and to have to be times.");
  }
}

View view_of(const Request& request) {
  View view;
  view.joint = number_of<std::size_t>(request, "joint") - 1;
  view.recording = number_of<std::size_t>(request, "recording") - 1;
  if (request.has_param("pixels")) view.pixels = number_of<std::size_t>(request, "pixels");
  if (request.has_param("beside")) view.beside = number_of<std::size_t>(request, "beside") - 1;
  set_range(request, view);
  return view;
}

// "x=velocity&x_joint=2": a variable of a joint, of the one that is shown where none is named.
ErrorOver over_of(const Request& request, const std::string& side) {
  const auto variable = error_variable(request.get_param_value(side));
  if (!variable) throw Refused(Refused::Why::kBadRequest, side + " has to be a variable.");
  const std::string joint = side + "_joint";
  const bool has_joint = request.has_param(joint);
  return {*variable, number_of<std::size_t>(request, has_joint ? joint.c_str() : "joint") - 1};
}

SpectrumOver spectrum_over_of(const Request& request) {
  const std::string over = request.get_param_value("over");
  if (over == "frequency") return SpectrumOver::kFrequency;
  if (over == "order") return SpectrumOver::kOrder;
  throw Refused(Refused::Why::kBadRequest, "over has to be frequency or order.");
}

ArmView arm_view_of(const Request& request) {
  ArmView view;
  view.recording = number_of<std::size_t>(request, "recording") - 1;
  if (request.has_param("instants")) view.instants = number_of<std::size_t>(request, "instants");
  set_range(request, view);
  return view;
}

void set_up_files(httplib::Server& server, const std::string& path) {
  const auto file = [&](const std::string& name, const std::string& content, const char* type) {
    server.Get(path + name, [content, type](const Request&, Response& response) {
      response.set_content(content, type);
    });
  };
  constexpr const char* kScript = "text/javascript; charset=utf-8";
  file("", std::string(assets::page()), "text/html; charset=utf-8");
  file("studio\\.css", std::string(assets::style()), "text/css; charset=utf-8");
  file("studio\\.js", std::string(assets::script()), kScript);
  file("arm_view\\.js", std::string(assets::arm_view()), kScript);
}

void set_up_model(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Get(api + "state", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.session()->state(); });
  });
  server.Get(api + "charts", [&stage](const Request& request, Response& response) {
    answer(response, [&] { return stage.session()->charts(view_of(request)); });
  });
  server.Get(api + "map", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      return stage.session()->map(view_of(request), over_of(request, "x"), over_of(request, "y"));
    });
  });
  server.Get(api + "spectrum", [&stage](const Request& request, Response& response) {
    answer(response,
           [&] { return stage.session()->spectrum(view_of(request), spectrum_over_of(request)); });
  });
  server.Get(api + "evidence", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      if (request.has_param("step")) {
        return stage.session()->evidence_of_step(number_of<std::size_t>(request, "step"));
      }
      return stage.session()->evidence_of_finding(number_of<std::size_t>(request, "search"),
                                                  number_of<std::size_t>(request, "finding"));
    });
  });
  server.Get(api + "arm", [&stage](const Request& request, Response& response) {
    answer(response, [&] { return stage.session()->arm(arm_view_of(request)); });
  });
  server.Post(api + "look", [&stage](const Request& request, Response& response) {
    answer(response, [&] { return stage.session()->look_at(view_from(body_of(request))); });
  });
  server.Post(api + "steps", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      const json body = body_of(request);
      return stage.session()->add(body.at("effect").get<std::string>(),
                                  body.at("joint").get<int>());
    });
  });
  server.Delete(api + "steps/([0-9]{1,9})", [&stage](const Request& request, Response& response) {
    answer(response, [&] { return stage.session()->undo(std::stoul(request.matches[1])); });
  });
  server.Delete(api + "steps", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.session()->undo_all(); });
  });
  server.Get(api + "moved", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      return stage.session()->moved(
          {number_of<std::size_t>(request, "step"), request.get_param_value("parameter"),
           number_of<double>(request, "value")},
          view_of(request));
    });
  });
  server.Post(api + "page", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      const json body = body_of(request);
      return stage.session()->save_page({body.value("name", ""), body.value("replace", false)});
    });
  });
  server.Post(api + "save", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      const json body = body_of(request);
      return stage.session()->save({body.value("name", ""), body.value("replace", false),
                                    body.value("accept_doubts", false)});
    });
  });
}

void set_up_search(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Get(api + "explanation", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.session()->explanation(); });
  });
  server.Post(api + "explanation", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.session()->start_to_explain(); });
  });
  server.Delete(api + "explanation", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.session()->stop_to_explain(); });
  });
  server.Post(api + "leave", [&stage](const Request&, Response& response) {
    stage.leave();
    response.status = 204;
  });
}

}  // namespace

void set_up_routes(httplib::Server& server, const std::string& path, Stage& stage) {
  set_up_files(server, path);
  set_up_model(server, path + "api/", stage);
  set_up_search(server, path + "api/", stage);
  set_up_live_routes(server, path + "api/", stage);
  set_up_load_routes(server, path + "api/", stage);
  set_up_results_routes(server, path + "api/", stage);
}

}  // namespace offnominal::desk::studio
