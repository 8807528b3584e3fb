#include "studio/load_routes.hpp"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "common/refused.hpp"
#include "studio/api.hpp"
#include "studio/intake.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

using nlohmann::json;

template <typename Value>
std::optional<Value> value_of(const json& body, const char* key) {
  if (!body.contains(key)) return std::nullopt;
  return body.at(key).get<Value>();
}

SignalEdit edit_of(const json& body) {
  SignalEdit edit;
  edit.quantity = body.at("quantity").get<std::string>();
  const auto joint = value_of<std::size_t>(body, "joint");
  if (!joint && edit.quantity != "time") {
    throw Refused(Refused::Why::kBadRequest,
                  "joint is missing; allowed: a joint of the robot, left out of the time alone.");
  }
  edit.joint = joint.value_or(1) - 1;
  edit.source = value_of<std::string>(body, "source");
  edit.unit = value_of<std::string>(body, "unit");
  edit.scale = value_of<double>(body, "scale");
  edit.of = value_of<std::string>(body, "of");
  edit.period_s = value_of<double>(body, "period_s");
  edit.file = value_of<std::size_t>(body, "file").value_or(1) - 1;
  edit.offset_s = value_of<double>(body, "offset_s");
  return edit;
}

Payload payload_from(const json& body) {
  return {
      body.at("mass_kg").get<double>(),
      {body.at("x_m").get<double>(), body.at("y_m").get<double>(), body.at("z_m").get<double>()}};
}

// As it comes, into the folder of such files.
std::filesystem::path received(const std::string& name, const httplib::Response& response,
                               const httplib::ContentReader& read, UploadFolder& folder) {
  UploadFolder::Upload upload = folder.begin(name);
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

void set_up_files(Api& api, Stage& stage) {
  api.on("GET /load", [&stage](const ApiRequest&) { return stage.intake().state(); });
  api.on_file(std::string("POST /") + kFilesRoute,
              [&stage](const ApiRequest& asked, const httplib::Response& response,
                       const httplib::ContentReader& read) {
                Intake& intake = stage.intake();
                const auto name = asked.parameters.at("name").get<std::string>();
                return intake.take(received(name, response, read, intake.folder()));
              });
  api.on(std::string("DELETE /") + kFilesRoute + "/{id}", [&stage](const ApiRequest& asked) {
    return stage.intake().remove(asked.parameters.at("id").get<std::size_t>());
  });
  api.on("POST /load/chain", [&stage](const ApiRequest& asked) {
    return stage.intake().choose_chain(asked.body.at("chain").get<std::size_t>() - 1);
  });
  api.on("POST /load/join", [&stage](const ApiRequest& asked) {
    return stage.intake().join(asked.body.at("recording").get<std::size_t>(),
                               asked.body.at("to").get<std::size_t>());
  });
  api.on("POST /load/split", [&stage](const ApiRequest& asked) {
    return stage.intake().split(asked.body.at("recording").get<std::size_t>());
  });
  api.on("POST /load/held_out", [&stage](const ApiRequest& asked) {
    return stage.intake().set_held_out(asked.body.at("recording").get<std::size_t>(),
                                       asked.body.at("held_out").get<bool>());
  });
  api.on("POST /load/payload", [&stage](const ApiRequest& asked) {
    return stage.intake().set_payload(asked.body.at("recording").get<std::size_t>(),
                                      payload_from(asked.body));
  });
  api.on("DELETE /load/payload/{id}", [&stage](const ApiRequest& asked) {
    return stage.intake().set_payload(asked.parameters.at("id").get<std::size_t>(), std::nullopt);
  });
}

void set_up_columns(Api& api, Stage& stage) {
  api.on("POST /load/signal", [&stage](const ApiRequest& asked) {
    return stage.intake().set_signal(edit_of(asked.body));
  });
  api.on("POST /load/at_rest", [&stage](const ApiRequest& asked) {
    return stage.intake().set_at_rest(asked.body.at("at_rest").get<bool>());
  });
  api.on("POST /load/written",
         [&stage](const ApiRequest&) { return stage.intake().write_at_rest(); });
  api.on("POST /load/guess", [&stage](const ApiRequest&) { return stage.intake().guess_again(); });
  api.on("GET /load/preview", [&stage](const ApiRequest& asked) {
    return stage.intake().preview(asked.parameters.at("recording").get<std::size_t>(),
                                  asked.parameters.at("pixels").get<std::size_t>());
  });
  api.on("GET /load/findings", [&stage](const ApiRequest& asked) {
    return stage.intake().findings(asked.parameters.at("recording").get<std::size_t>(),
                                   asked.parameters.at("pixels").get<std::size_t>());
  });
  api.on("POST /load/session", [&stage](const ApiRequest& asked) {
    return stage.use_files(asked.body.at("replace").get<bool>());
  });
}

}  // namespace

void set_up_load_routes(Api& api, Stage& stage) {
  set_up_files(api, stage);
  set_up_columns(api, stage);
}

}  // namespace offnominal::desk::studio
