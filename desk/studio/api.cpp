#include "studio/api.hpp"

#include <exception>
#include <stdexcept>
#include <string_view>

#include "common/error.hpp"
#include "common/refused.hpp"
#include "studio/assets.hpp"

namespace offnominal::desk::studio {
namespace {

using httplib::Request;
using httplib::Response;

constexpr std::string_view kId = "{id}";
constexpr const char* kJson = "application/json; charset=utf-8";

void refuse(Response& response, int status, const std::string& words, bool confirm = false) {
  response.status = status;
  response.set_content(text_of(nlohmann::json{{"error", on_one_line(words)}, {"confirm", confirm}}),
                       kJson);
}

// What `make` does, or why it cannot.
template <typename Make>
void answer(Response& response, const Make& make) {
  try {
    make();
  } catch (const Refused& refused) {
    const bool bad = refused.why() == Refused::Why::kBadRequest;
    refuse(response, bad ? 400 : 409, refused.what(), refused.why() == Refused::Why::kMustConfirm);
  } catch (const InputError& error) {
    refuse(response, 422, error.what());
  } catch (const std::exception& error) {
    refuse(response, 500, error.what());
  }
}

ApiRequest asked_by(const Request& request, const std::string& route, const ApiContract& contract) {
  ApiContract::Sent all{request.params, request.get_header_value("Content-Type"), request.body};
  if (request.matches.size() > 1) all.parameters.emplace("id", request.matches[1].str());
  return contract.asked(route, all);
}

std::string method_of(const std::string& route) { return route.substr(0, route.find(' ')); }

}  // namespace

Api::Api(httplib::Server& server, std::string path)
    : server_(server),
      path_(std::move(path)),
      contract_(std::make_shared<const ApiContract>(assets::api())) {}

std::string Api::pattern_of(const std::string& route) const {
  std::string pattern = path_ + route.substr(route.find('/') + 1);
  const std::size_t id = pattern.find(kId);
  if (id != std::string::npos) pattern.replace(id, kId.size(), "([^/]+)");
  return pattern;
}

void Api::add(const std::string& route, const Answer& give) {
  const bool has_answer = contract_->has_answer(route);
  const auto handle = [route, give, has_answer, contract = contract_](const Request& request,
                                                                      Response& response) {
    answer(response, [&] {
      const std::string text = give(asked_by(request, route, *contract));
      if (has_answer) {
        response.set_content(text, kJson);
      } else {
        response.status = 204;
      }
    });
  };
  const std::string method = method_of(route);
  if (method == "GET") server_.Get(pattern_of(route), handle);
  if (method == "POST") server_.Post(pattern_of(route), handle);
  if (method == "DELETE") server_.Delete(pattern_of(route), handle);
  routes_.insert(route);
}

void Api::on_file(const std::string& route, const Take& take) {
  static_cast<void>(contract_->has_answer(route));
  server_.Post(pattern_of(route),
               [route, take, contract = contract_](const Request& request, Response& response,
                                                   const httplib::ContentReader& read) {
                 answer(response, [&] {
                   const ApiRequest asked = asked_by(request, route, *contract);
                   response.set_content(text_of(take(asked, response, read)), kJson);
                 });
                 // What was not read of a body would be the next request.
                 if (response.status >= 400) response.set_header("Connection", "close");
               });
  routes_.insert(route);
}

void Api::require_all() const {
  for (const std::string& route : contract_->routes()) {
    if (!routes_.contains(route)) throw std::logic_error("the server has no " + route);
  }
}

}  // namespace offnominal::desk::studio
