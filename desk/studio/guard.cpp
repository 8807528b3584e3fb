#include "studio/guard.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace offnominal::desk::studio {
namespace {

// In the same time wherever they differ.
bool begins_with_secret(std::string_view text, std::string_view secret) {
  if (text.size() < secret.size()) return false;
  int differ = 0;
  for (std::size_t i = 0; i < secret.size(); ++i) differ |= text[i] ^ secret[i];
  return differ == 0;
}

}  // namespace

std::string random_token() {
  std::array<std::uint8_t, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::system_error(errno, std::generic_category(), "no random numbers");
  }
  std::string token;
  for (const std::uint8_t byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

std::string Guard::address() const { return fmt::format("http://127.0.0.1:{}{}", port_, path()); }

int Guard::refusal(const Asked& asked) const {
  const std::array<std::string, 2> own = {fmt::format("127.0.0.1:{}", port_),
                                          fmt::format("localhost:{}", port_)};
  if (asked.host != own[0] && asked.host != own[1]) return 403;
  const bool reads = asked.method == "GET";
  if (!reads && asked.method != "POST" && asked.method != "DELETE") return 405;
  // What changes something says where it comes from; so do browsers.
  const bool may_be_silent = reads && asked.origin.empty();
  if (!may_be_silent && asked.origin != "http://" + own[0] && asked.origin != "http://" + own[1]) {
    return 403;
  }
  if (!begins_with_secret(asked.path, path())) return 404;
  const bool opens = asked.path.size() == path().size();  // a link may lead here from anywhere
  if (!opens && !asked.site.empty() && asked.site != "same-origin" && asked.site != "none") {
    return 403;
  }
  return 0;
}

}  // namespace offnominal::desk::studio
