#pragma once

#include <string>

namespace httplib {
class Server;
}

namespace offnominal::desk::studio {

class Stage;

/// The part of the API below `api`, as set_up_routes() has it, that is of a live view. `stage` has
/// to outlive the server.
void set_up_live_routes(httplib::Server& server, const std::string& api, Stage& stage);

}  // namespace offnominal::desk::studio
