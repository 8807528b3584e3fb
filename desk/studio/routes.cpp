#include "studio/routes.hpp"

#include <nlohmann/json.hpp>
#include <string_view>

#include "common/refused.hpp"
#include "studio/api.hpp"
#include "studio/assets.hpp"
#include "studio/charts.hpp"
#include "studio/live_routes.hpp"
#include "studio/load_routes.hpp"
#include "studio/results_routes.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;

std::size_t number_in(const json& parameters, const char* name) {
  return parameters.at(name).get<std::size_t>();
}

// The part of the time that is shown, where the request names one.
template <typename Any>
void set_range(const json& parameters, Any& view) {
  if (parameters.contains("from")) view.from_s = parameters["from"].template get<double>();
  if (parameters.contains("to")) view.to_s = parameters["to"].template get<double>();
  check_shown(view.from_s, view.to_s);
}

View view_of(const json& parameters) {
  View view;
  view.joint = number_in(parameters, "joint") - 1;
  view.recording = number_in(parameters, "recording") - 1;
  if (parameters.contains("pixels")) view.pixels = number_in(parameters, "pixels");
  if (parameters.contains("beside")) view.beside = number_in(parameters, "beside") - 1;
  set_range(parameters, view);
  return view;
}

// "x=velocity&x_joint=2": a variable of a joint, of the one that is shown where none is named.
ErrorOver over_of(const json& parameters, const std::string& side) {
  const std::string joint = side + "_joint";
  const bool has_joint = parameters.contains(joint);
  return {error_variable(parameters.at(side).get<std::string>()).value(),
          number_in(parameters, has_joint ? joint.c_str() : "joint") - 1};
}

ArmView arm_view_of(const json& parameters) {
  ArmView view;
  view.recording = number_in(parameters, "recording") - 1;
  view.instants = number_in(parameters, "instants");
  set_range(parameters, view);
  return view;
}

json evidence_of(Session& session, const json& parameters) {
  if (parameters.contains("step")) return session.evidence_of_step(number_in(parameters, "step"));
  if (!parameters.contains("search") || !parameters.contains("finding")) {
    throw Refused(Refused::Why::kBadRequest,
                  "step is missing; allowed: it, or search and finding.");
  }
  return session.evidence_of_finding(number_in(parameters, "search"),
                                     number_in(parameters, "finding"));
}

SaveRequest save_request_of(const json& body) {
  return {body.at("name").get<std::string>(), body.at("replace").get<bool>(),
          body.value("accept_doubts", false)};
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

void set_up_views(Api& api, Stage& stage) {
  api.on("GET /state", [&stage](const ApiRequest&) { return stage.session()->state(); });
  api.on("GET /charts", [&stage](const ApiRequest& asked) {
    return stage.session()->charts(view_of(asked.parameters));
  });
  api.on("GET /map", [&stage](const ApiRequest& asked) {
    return stage.session()->map(view_of(asked.parameters), over_of(asked.parameters, "x"),
                                over_of(asked.parameters, "y"));
  });
  api.on("GET /spectrum", [&stage](const ApiRequest& asked) {
    const bool is_frequency = asked.parameters.at("over") == "frequency";
    return stage.session()->spectrum(
        view_of(asked.parameters), is_frequency ? SpectrumOver::kFrequency : SpectrumOver::kOrder);
  });
  api.on("GET /evidence", [&stage](const ApiRequest& asked) {
    return evidence_of(*stage.session(), asked.parameters);
  });
  api.on("GET /moved", [&stage](const ApiRequest& asked) {
    return stage.session()->moved(
        {number_in(asked.parameters, "step"), asked.parameters.at("parameter").get<std::string>(),
         asked.parameters.at("value").get<double>()},
        view_of(asked.parameters));
  });
  api.on("GET /arm", [&stage](const ApiRequest& asked) {
    return stage.session()->arm(arm_view_of(asked.parameters));
  });
  api.on("POST /look", [&stage](const ApiRequest& asked) {
    return stage.session()->look_at(view_from(asked.body));
  });
}

void set_up_model(Api& api, Stage& stage) {
  api.on("POST /steps", [&stage](const ApiRequest& asked) {
    return stage.session()->add(asked.body.at("effect").get<std::string>(),
                                asked.body.at("joint").get<int>());
  });
  api.on("DELETE /steps/{id}", [&stage](const ApiRequest& asked) {
    return stage.session()->undo(number_in(asked.parameters, "id"));
  });
  api.on("DELETE /steps", [&stage](const ApiRequest&) { return stage.session()->undo_all(); });
  api.on("POST /page", [&stage](const ApiRequest& asked) {
    return stage.session()->save_page(save_request_of(asked.body));
  });
  api.on("POST /save", [&stage](const ApiRequest& asked) {
    return stage.session()->save(save_request_of(asked.body));
  });
}

void set_up_search(Api& api, Stage& stage) {
  api.on("GET /explanation",
         [&stage](const ApiRequest&) { return stage.session()->explanation(); });
  api.on("POST /explanation",
         [&stage](const ApiRequest&) { return stage.session()->start_to_explain(); });
  api.on("DELETE /explanation",
         [&stage](const ApiRequest&) { return stage.session()->stop_to_explain(); });
  api.on("POST /leave", [&stage](const ApiRequest&) { stage.leave(); });
}

}  // namespace

void set_up_routes(httplib::Server& server, const std::string& path, Stage& stage) {
  set_up_files(server, path);
  Api api(server, path + "api/");
  set_up_views(api, stage);
  set_up_model(api, stage);
  set_up_search(api, stage);
  set_up_live_routes(api, stage);
  set_up_load_routes(api, stage);
  set_up_results_routes(api, stage);
  api.require_all();
}

}  // namespace offnominal::desk::studio
