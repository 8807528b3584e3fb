#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "common/file.hpp"
#include "report/assets.hpp"
#include "report/page.hpp"

namespace offnominal::desk::report {
namespace {

std::string escape_html(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// JSON that can stand inside a script element: neither `</script` nor `<!--` can occur in it.
/// In JSON a `<` stands inside strings only, where \u003c means the same.
std::string script_safe(const nlohmann::json& value) {
  const std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

/// Replaces each {{name}} of the template; what is put in is not searched again.
std::string fill(std::string_view text, const std::map<std::string_view, std::string_view>& parts) {
  std::string filled;
  for (;;) {
    const std::size_t open = text.find("{{");
    filled += text.substr(0, open);
    if (open == std::string_view::npos) return filled;
    text.remove_prefix(open + 2);
    const std::size_t close = text.find("}}");
    if (close == std::string_view::npos) throw std::logic_error("page.html: {{ without }}");
    filled += parts.at(text.substr(0, close));
    text.remove_prefix(close + 2);
  }
}

}  // namespace

std::string render(const Page& page) {
  const nlohmann::json content = to_json(page);
  const std::string data = script_safe(content);
  const auto version = content.at("version").get<std::string>();
  const std::string title = escape_html(page.title);
  const std::string verdict = escape_html(page.verdict.words);
  return fill(assets::page_template(), {{"version", version},
                                        {"title", title},
                                        {"verdict", verdict},
                                        {"style", assets::style()},
                                        {"data", data},
                                        {"script", assets::script()}});
}

void write_page(const std::filesystem::path& path, const Page& page, Existing existing) {
  write_file_atomically(path, render(page), is_page(path) ? Existing::kReplace : existing);
}

bool is_page(const std::filesystem::path& file) {
  constexpr std::string_view kBegin = "<!doctype html>";
  constexpr std::string_view kGenerator = "<meta name=\"generator\" content=\"offnominal ";
  constexpr std::size_t kHead = 512;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;
  std::string head(kHead, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), kHead);
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return head.starts_with(kBegin) && head.find(kGenerator) != std::string::npos;
}

}  // namespace offnominal::desk::report
