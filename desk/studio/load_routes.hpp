#pragma once

namespace offnominal::desk::studio {

class Api;
class Stage;

/// Where a page hands files over, below `api`: the one request that may be longer than kMostBody.
inline constexpr const char* kFilesRoute = "load/files";

/// The part of the API that leads from files to a session. `stage` has to outlive the server.
void set_up_load_routes(Api& api, Stage& stage);

}  // namespace offnominal::desk::studio
