#pragma once

#include <string>

namespace httplib {
class Server;
}

namespace offnominal::desk::studio {

class Stage;

/// Longest body of a request, bytes.
inline constexpr std::size_t kMostBody = 16 * 1024;

/// Puts the page, its files and the API of docs/studio.md below `path`, which begins and ends with
/// a slash and has no character that a regular expression has plans for. `stage` has to outlive
/// the server.
void set_up_routes(httplib::Server& server, const std::string& path, Stage& stage);

}  // namespace offnominal::desk::studio
