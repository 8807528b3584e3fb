#include "studio/load_routes.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/refused.hpp"
#include "studio/charts.hpp"
#include "studio/intake.hpp"
#include "studio/requests.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;

std::size_t pixels_in(const Request& request) {
  const auto pixels = number_of<std::size_t>(request, "pixels");
  if (pixels >= kFewestPixels && pixels <= kMostPixels) return pixels;
  throw Refused(Refused::Why::kBadRequest, "pixels has to be the width of a picture.");
}

template <typename Value>
std::optional<Value> value_of(const json& body, const char* key) {
  if (!body.contains(key)) return std::nullopt;
  return body.at(key).get<Value>();
}

SignalEdit edit_of(const json& body) {
  SignalEdit edit;
  edit.quantity = body.at("quantity").get<std::string>();
  // Of the time there is none; 0 is no joint.
  const json& joint = body.value("joint", json(1));
  edit.joint = joint.get<std::size_t>() - 1;
  edit.source = value_of<std::string>(body, "source");
  edit.unit = value_of<std::string>(body, "unit");
  edit.scale = value_of<double>(body, "scale");
  edit.of = value_of<std::string>(body, "of");
  edit.period_s = value_of<double>(body, "period_s");
  return edit;
}

// As it comes, into the folder of such files.
std::filesystem::path received(const Request& request, const Response& response,
                               const httplib::ContentReader& read, UploadFolder& folder) {
  if (request.is_multipart_form_data()) {
    throw Refused(Refused::Why::kBadRequest, "A file is handed over as the body itself.");
  }
  UploadFolder::Upload upload = folder.begin(request.get_param_value("name"));
  std::optional<InputError> refused;
  const bool whole = read([&](const char* data, std::size_t size) {
    try {
      upload.write(data, size);
    } catch (const InputError& error) {
      refused = error;
    }
    return !refused;
  });
  if (refused) throw InputError(refused->problem());
  if (!whole && response.status == 413) throw upload.too_long();
  if (!whole) throw Refused(Refused::Why::kBadRequest, "The file broke off.");
  return upload.finish();
}

void set_up_files(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Get(api + "load", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.intake().state(); });
  });
  server.Post(api + kFilesRoute, [&stage](const Request& request, Response& response,
                                          const httplib::ContentReader& read) {
    answer(response, [&] {
      Intake& intake = stage.intake();
      return intake.take(received(request, response, read, intake.folder()));
    });
    // What was not read of a body would be the next request.
    if (response.status >= 400) response.set_header("Connection", "close");
  });
  server.Delete(api + kFilesRoute + std::string("/([0-9]{1,9})"), [&stage](const Request& request,
                                                                           Response& response) {
    answer(response, [&] { return stage.intake().remove(std::stoul(request.matches[1])); });
  });
  server.Post(api + "load/held_out", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      const json body = body_of(request);
      return stage.intake().set_held_out(body.at("recording").get<std::size_t>(),
                                         body.at("held_out").get<bool>());
    });
  });
}

void set_up_columns(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Post(api + "load/signal", [&stage](const Request& request, Response& response) {
    answer(response, [&] { return stage.intake().set_signal(edit_of(body_of(request))); });
  });
  server.Post(api + "load/guess", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.intake().guess_again(); });
  });
  server.Get(api + "load/preview", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      return stage.intake().preview(number_of<std::size_t>(request, "recording"),
                                    pixels_in(request));
    });
  });
  server.Get(api + "load/findings", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      return stage.intake().findings(number_of<std::size_t>(request, "recording"),
                                     pixels_in(request));
    });
  });
  server.Post(api + "load/session", [&stage](const Request& request, Response& response) {
    answer(response, [&] { return stage.use_files(body_of(request).value("replace", false)); });
  });
}

}  // namespace

void set_up_load_routes(httplib::Server& server, const std::string& api, Stage& stage) {
  set_up_files(server, api, stage);
  set_up_columns(server, api, stage);
}

}  // namespace offnominal::desk::studio
