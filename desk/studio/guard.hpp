#pragma once

#include <string>
#include <string_view>

namespace offnominal::desk::studio {

/// 128 bits that nobody can guess, as 32 hexadecimal digits. Throws std::system_error where the
/// system has none.
[[nodiscard]] std::string random_token();

/// Who may ask: only who knows the token, and only a page that this server has given out. Another
/// page that a name was turned to 127.0.0.1 for (DNS rebinding) has another Host, a page from
/// elsewhere has another Origin.
class Guard {
 public:
  Guard(std::string token, int port) : token_(std::move(token)), port_(port) {}

  struct Asked {
    std::string_view method;
    std::string_view path;
    std::string_view host;
    std::string_view origin;  // empty: none was sent
    std::string_view site;    // Sec-Fetch-Site, empty: none was sent
  };
  /// 0: may pass. Otherwise the HTTP status that refuses it: 403 for a wrong host, origin or site,
  /// 404 for a path without the token, 405 for another method than GET, POST and DELETE.
  [[nodiscard]] int refusal(const Asked& asked) const;

  [[nodiscard]] std::string path() const { return "/" + token_ + "/"; }
  [[nodiscard]] std::string address() const;

 private:
  std::string token_;
  int port_;
};

}  // namespace offnominal::desk::studio
