#include "studio/results_routes.hpp"

#include <cstdint>
#include <nlohmann/json.hpp>

#include "studio/api.hpp"
#include "studio/results_view.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

ResultsFilter filter_of(const ApiRequest& asked) {
  ResultsFilter filter;
  for (const auto& parameter : asked.parameters.items()) {
    if (parameter.key() != "from") filter[parameter.key()] = parameter.value();
  }
  return filter;
}

}  // namespace

void set_up_results_routes(Api& api, Stage& stage) {
  api.on("GET /results", [&stage](const ApiRequest&) { return stage.results().state(); });
  api.on("GET /results/figures",
         [&stage](const ApiRequest& asked) { return stage.results().figures(filter_of(asked)); });
  api.on("GET /results/runs", [&stage](const ApiRequest& asked) {
    return stage.results().runs(filter_of(asked), asked.parameters.at("from").get<std::size_t>());
  });
  api.on("GET /results/watched", [&stage](const ApiRequest& asked) {
    return stage.results().watched(asked.parameters.at("run").get<std::int64_t>(),
                                   asked.parameters.at("detector").get<std::string>());
  });
  api.on("POST /results/session", [&stage](const ApiRequest& asked) {
    return stage.open_run(asked.body.at("run").get<std::int64_t>(),
                          asked.body.at("replace").get<bool>());
  });
}

}  // namespace offnominal::desk::studio
