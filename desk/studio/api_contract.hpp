#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace offnominal::desk::studio {

/// What a route is asked, as the document allows it: all that is required is there and nothing that
/// is not known, and what has a default is always there.
struct ApiRequest {
  nlohmann::json parameters;  // of query and path; numbers are numbers
  nlohmann::json body;        // an object; null where the route takes none, or a file
};

/// The OpenAPI document of the API, desk/studio/api/openapi.json, as the server keeps to it. May be
/// used by several threads at once.
class ApiContract {
 public:
  /// Throws std::exception for a document that is none.
  explicit ApiContract(std::string_view document);
  ApiContract(const ApiContract&) = delete;
  ApiContract& operator=(const ApiContract&) = delete;
  ~ApiContract();

  /// "DELETE /steps/{id}" and the like, in order.
  [[nodiscard]] std::vector<std::string> routes() const;
  /// Whether its answer has a body. Throws std::out_of_range for a route that is not in the
  /// document; so does asked().
  [[nodiscard]] bool has_answer(const std::string& route) const;

  struct Sent {
    std::multimap<std::string, std::string> parameters;  // of query and path, as text
    std::string content_type;
    std::string_view body;  // of a file it counts for nothing
  };
  /// Throws Refused where the document does not allow it: which field, what was found, what is
  /// allowed.
  [[nodiscard]] ApiRequest asked(const std::string& route, const Sent& sent) const;

 private:
  struct Route;
  [[nodiscard]] const Route& route_of(const std::string& route) const;
  [[nodiscard]] nlohmann::json parameters_of(const Route& route, const Sent& sent) const;
  [[nodiscard]] nlohmann::json body_of(const Route& route, const Sent& sent) const;

  nlohmann::json document_;
  std::map<std::string, std::unique_ptr<const Route>> routes_;
};

}  // namespace offnominal::desk::studio
