#include "studio/routes.hpp"

#include <httplib.h>

#include <charconv>
#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/error.hpp"
#include "report/assets.hpp"
#include "studio/assets.hpp"
#include "studio/refused.hpp"
#include "studio/session.hpp"

namespace offnominal::desk::studio {
namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;

constexpr const char* kJson = "application/json; charset=utf-8";

template <typename Json>
void set_json(Response& response, const Json& value) {
  response.set_content(value.dump(-1, ' ', false, Json::error_handler_t::replace), kJson);
}

void refuse(Response& response, int status, const std::string& words, bool confirm = false) {
  response.status = status;
  set_json(response, json{{"error", on_one_line(words)}, {"confirm", confirm}});
}

// What `make` gives, or why there is none.
template <typename Make>
void answer(Response& response, const Make& make) {
  try {
    set_json(response, make());
  } catch (const Refused& refused) {
    const bool bad = refused.why() == Refused::Why::kBadRequest;
    refuse(response, bad ? 400 : 409, refused.what(), refused.why() == Refused::Why::kMustConfirm);
  } catch (const json::exception&) {
    refuse(response, 400, "The request is not understood.");
  } catch (const InputError& error) {
    refuse(response, 422, error.what());
  } catch (const std::exception& error) {
    refuse(response, 500, error.what());
  }
}

template <typename Number>
Number number_of(const Request& request, const char* name) {
  const std::string text = request.get_param_value(name);
  Number value{};
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (text.empty() || read.ec != std::errc{} || read.ptr != end) {
    throw Refused(Refused::Why::kBadRequest, std::string(name) + " has to be a number.");
  }
  return value;
}

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
  view.pixels = number_of<std::size_t>(request, "pixels");
  set_range(request, view);
  return view;
}

ArmView arm_view_of(const Request& request) {
  ArmView view;
  view.recording = number_of<std::size_t>(request, "recording") - 1;
  if (request.has_param("instants")) view.instants = number_of<std::size_t>(request, "instants");
  set_range(request, view);
  return view;
}

json body_of(const Request& request) {
  if (!request.get_header_value("Content-Type").starts_with("application/json")) {
    throw Refused(Refused::Why::kBadRequest, "The body has to be JSON.");
  }
  return json::parse(request.body);
}

void set_up_files(httplib::Server& server, const std::string& path) {
  const auto file = [&](const std::string& name, const std::string& content, const char* type) {
    server.Get(path + name, [content, type](const Request&, Response& response) {
      response.set_content(content, type);
    });
  };
  constexpr const char* kScript = "text/javascript; charset=utf-8";
  file("", std::string(assets::page()), "text/html; charset=utf-8");
  file("studio\\.css", std::string(report::assets::style()) + std::string(assets::style()),
       "text/css; charset=utf-8");
  file("echarts\\.js", std::string(report::assets::echarts()), kScript);
  file("report\\.js", std::string(report::assets::script()), kScript);
  file("studio\\.js", std::string(assets::script()), kScript);
  // The modules of the arm, under the names by which they import each other.
  file("arm_view\\.js", std::string(assets::arm_view()), kScript);
  file("orbit_controls\\.js", std::string(assets::orbit_controls()), kScript);
  file("three\\.module\\.min\\.js", std::string(assets::three()), kScript);
  file("three\\.core\\.min\\.js", std::string(assets::three_core()), kScript);
}

void set_up_model(httplib::Server& server, const std::string& api, Session& session) {
  server.Get(api + "state", [&session](const Request&, Response& response) {
    answer(response, [&] { return session.state(); });
  });
  server.Get(api + "charts", [&session](const Request& request, Response& response) {
    answer(response, [&] {
      return session.charts(view_of(request), request.get_param_value("only") == "time");
    });
  });
  server.Get(api + "arm", [&session](const Request& request, Response& response) {
    answer(response, [&] { return session.arm(arm_view_of(request)); });
  });
  server.Post(api + "steps", [&session](const Request& request, Response& response) {
    answer(response, [&] {
      const json body = body_of(request);
      return session.add(body.at("effect").get<std::string>(), body.at("joint").get<int>());
    });
  });
  server.Delete(api + "steps/([0-9]{1,9})", [&session](const Request& request, Response& response) {
    answer(response, [&] { return session.undo(std::stoul(request.matches[1])); });
  });
  server.Post(api + "save", [&session](const Request& request, Response& response) {
    answer(response, [&] {
      const json body = body_of(request);
      return session.save({body.value("name", ""), body.value("replace", false),
                           body.value("accept_doubts", false)});
    });
  });
}

void set_up_search(httplib::Server& server, const std::string& api, Session& session) {
  server.Get(api + "explanation", [&session](const Request&, Response& response) {
    answer(response, [&] { return session.explanation(); });
  });
  server.Post(api + "explanation", [&session](const Request&, Response& response) {
    answer(response, [&] { return session.start_to_explain(); });
  });
  server.Delete(api + "explanation", [&session](const Request&, Response& response) {
    answer(response, [&] { return session.stop_to_explain(); });
  });
  server.Post(api + "leave", [&session](const Request&, Response& response) {
    session.leave();
    response.status = 204;
  });
}

}  // namespace

void set_up_routes(httplib::Server& server, const std::string& path, Session& session) {
  set_up_files(server, path);
  set_up_model(server, path + "api/", session);
  set_up_search(server, path + "api/", session);
}

}  // namespace offnominal::desk::studio
