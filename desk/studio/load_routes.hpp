#pragma once

#include <string>

namespace httplib {
class Server;
}

namespace offnominal::desk::studio {

class Stage;

/// Where a page hands files over, below `api`: the one request that may be longer than kMostBody.
inline constexpr const char* kFilesRoute = "load/files";

/// The part of the API below `api`, as set_up_routes() has it, that leads from files to a session.
/// `stage` has to outlive the server.
void set_up_load_routes(httplib::Server& server, const std::string& api, Stage& stage);

}  // namespace offnominal::desk::studio
