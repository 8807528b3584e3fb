#include "studio/campaign_routes.hpp"

#include <nlohmann/json.hpp>

#include "studio/campaign_view.hpp"
#include "studio/requests.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

using httplib::Request;
using httplib::Response;

RunFilter filter_of(const Request& request) {
  RunFilter filter;
  if (request.has_param("detector")) filter.detector = request.get_param_value("detector");
  if (request.has_param("kind")) filter.kind = request.get_param_value("kind");
  if (request.has_param("joint")) filter.joint = number_of<int>(request, "joint");
  filter.outcome = request.get_param_value("outcome");
  return filter;
}

}  // namespace

void set_up_campaign_routes(httplib::Server& server, const std::string& api, Stage& stage) {
  server.Get(api + "campaign", [&stage](const Request&, Response& response) {
    answer(response, [&] { return stage.campaign().state(); });
  });
  server.Get(api + "campaign/figures", [&stage](const Request& request, Response& response) {
    answer(response, [&] { return stage.campaign().figures(filter_of(request)); });
  });
  server.Get(api + "campaign/runs", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      return stage.campaign().runs(filter_of(request), number_of<std::size_t>(request, "from"));
    });
  });
  server.Post(api + "campaign/session", [&stage](const Request& request, Response& response) {
    answer(response, [&] {
      const nlohmann::json body = body_of(request);
      return stage.open_run(body.at("run").get<std::int64_t>(), body.value("replace", false));
    });
  });
}

}  // namespace offnominal::desk::studio
