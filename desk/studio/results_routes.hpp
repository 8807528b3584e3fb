#pragma once

#include <string>

namespace httplib {
class Server;
}

namespace offnominal::desk::studio {

class Stage;

/// The part of the API below `api`, as set_up_routes() has it, that is of results of many runs.
/// `stage` has to outlive the server.
void set_up_results_routes(httplib::Server& server, const std::string& api, Stage& stage);

}  // namespace offnominal::desk::studio
