#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "studio/api_contract.hpp"
#include "studio/http.hpp"

namespace offnominal::desk::studio {

/// As an answer has it.
template <typename Json>
[[nodiscard]] std::string text_of(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The API on a server, below a path. Every request is held against the document before anything is
/// done; what is thrown becomes a refusal: Refused 400 or 409, InputError 422, all else 500.
class Api {
 public:
  /// `path` ends with a slash and has no character that a regular expression has plans for.
  Api(httplib::Server& server, std::string path);

  /// `make` gives the answer, a JSON value, or nothing: an object without fields. `route` as
  /// ApiContract has it. Throws std::out_of_range where it is not in the document.
  template <typename Make>
  void on(const std::string& route, Make make) {
    add(route, [make = std::move(make)](const ApiRequest& asked) {
      if constexpr (std::is_void_v<std::invoke_result_t<const Make&, const ApiRequest&>>) {
        make(asked);
        return text_of(nlohmann::json::object());
      } else {
        return text_of(make(asked));
      }
    });
  }

  /// Takes a file as it comes, `read`; whatever a refusal left of it is not read.
  using Take = std::function<nlohmann::ordered_json(
      const ApiRequest& asked, const httplib::Response&, const httplib::ContentReader& read)>;
  void on_file(const std::string& route, const Take& take);

  /// Throws std::logic_error where a route of the document is missing.
  void require_all() const;

 private:
  using Answer = std::function<std::string(const ApiRequest&)>;
  void add(const std::string& route, const Answer& give);
  // How httplib has its path.
  [[nodiscard]] std::string pattern_of(const std::string& route) const;

  httplib::Server& server_;
  std::string path_;
  std::shared_ptr<const ApiContract> contract_;
  std::set<std::string> routes_;
};

}  // namespace offnominal::desk::studio
