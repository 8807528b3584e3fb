#include "studio/results_routes.hpp"

#include <nlohmann/json.hpp>

#include "studio/requests.hpp"
#include "studio/results_view.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

using httplib::Request;
using httplib::Response;

ResultsFilter filter_of(const Request& request) {
  ResultsFilter filter;
  for (const auto& [key, value] : request.params) {
    if (key != "from") filter[key] = value;
  }
  return filter;
}

}  // namespace

void set_up_results_routes(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Get(api + "results", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.results().state(); });
  });
  server.Get(api + "results/figures", [&stage](const Request& request, Response& response) {
    answer(response, [&] { return stage.results().figures(filter_of(request)); });
  });
  server.Get(api + "results/runs", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      return stage.results().runs(filter_of(request), number_of<std::size_t>(request, "from"));
    });
  });
  server.Post(api + "results/session", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      const nlohmann::json body = body_of(request);
      return stage.open_run(body.at("run").get<std::int64_t>(), body.value("replace", false));
    });
  });
}

}  // namespace offnominal::desk::studio
