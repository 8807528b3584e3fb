#include "studio/server.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/error.hpp"
#include "studio/guard.hpp"
#include "studio/http.hpp"
#include "studio/load_routes.hpp"
#include "studio/routes.hpp"
#include "studio/stage.hpp"

namespace offnominal::desk::studio {
namespace {

constexpr const char* kHost = "127.0.0.1";
// A browser keeps up to six connections, each of which holds a thread.
constexpr std::size_t kThreads = 16;
// What the end of the server waits for, at most; a connection of this machine is soon made anew.
constexpr int kIdleS = 1;
constexpr int kReadS = 5;

const httplib::Headers kHeaders = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' "
     "data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors "
     "'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"},
};

int port_of(httplib::Server& server, int port) {
  if (port == 0) {
    const int chosen = server.bind_to_any_port(kHost);
    if (chosen > 0) return chosen;
  } else if (server.bind_to_port(kHost, port)) {
    return port;
  }
  throw InputError({"--port", "", std::to_string(port) + ", which cannot be taken",
                    "a port of 127.0.0.1 that is free", "leave --port out: a free one is chosen"});
}

// More than any limit where it is no number.
std::uint64_t length_of(const httplib::Request& request) {
  if (!request.has_header("Content-Length")) return 0;
  const std::string text = request.get_header_value("Content-Length");
  std::uint64_t length = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, length);
  return read.ec == std::errc{} && read.ptr == end ? length
                                                   : std::numeric_limits<std::uint64_t>::max();
}

}  // namespace

struct Server::Parts {
  template <typename... Shown>
  explicit Parts(int asked_port, Shown&&... shown)
      : stage(std::forward<Shown>(shown)...),
        port((set_up(), port_of(http, asked_port))),
        guard(random_token(), port) {
    set_up_routes(http, guard.path(), stage);
    http.set_pre_routing_handler(
        [this](const httplib::Request& request, httplib::Response& response) {
          return let_in(request, response);
        });
  }

  void set_up() {
    // Made once the server listens: only from then on can httplib stop it.
    http.new_task_queue = [this] {
      listens = true;
      if (is_to_stop) stop_once();
      return new httplib::ThreadPool(kThreads);
    };
    // Of what may come at all; let_in() knows of what.
    http.set_payload_max_length(
        stage.takes_files()
            ? std::max<std::uint64_t>(stage.intake().folder().limits().file, kMostBody)
            : kMostBody);
    http.set_keep_alive_timeout(kIdleS);
    http.set_read_timeout(kReadS);
    http.set_tcp_nodelay(true);
    http.set_default_headers(kHeaders);
    // httplib's own option lets another server share the port.
    http.set_socket_options([](socket_t socket) {
      const int yes = 1;
      static_cast<void>(::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes));
    });
  }

  httplib::Server::HandlerResponse let_in(const httplib::Request& request,
                                          httplib::Response& response) const {
    const std::string host = request.get_header_value("Host");
    const std::string origin = request.get_header_value("Origin");
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    int refusal = guard.refusal({request.method, request.path, host, origin, site});
    // Of a body in pieces, or of one that ends with the connection, httplib takes any length.
    const bool is_of_known_length =
        !request.has_header("Transfer-Encoding") &&
        (request.method != "POST" || request.has_header("Content-Length"));
    if (refusal == 0 && !is_of_known_length) refusal = 411;
    // No body is unpacked: what is packed could be of any length.
    if (refusal == 0 && request.has_header("Content-Encoding")) refusal = 415;
    // A file is received by its own route, which knows what may be too long of it.
    const bool is_file = request.path == guard.path() + "api/" + kFilesRoute;
    if (refusal == 0 && !is_file && length_of(request) > kMostBody) refusal = 413;
    if (refusal == 0) return httplib::Server::HandlerResponse::Unhandled;
    response.status = refusal;
    response.set_header("Connection", "close");
    response.set_content("Not for you.\n", "text/plain; charset=utf-8");
    return httplib::Server::HandlerResponse::Handled;
  }

  // httplib does not take it twice.
  void stop_once() {
    if (!has_stopped.exchange(true)) http.stop();
  }

  Stage stage;
  httplib::Server http;
  std::atomic<bool> listens = false;
  std::atomic<bool> is_to_stop = false;
  std::atomic<bool> has_stopped = false;
  int port;
  Guard guard;
};

Server::Server(Input input, int port) : parts_(std::make_unique<Parts>(port, std::move(input))) {}
Server::Server(std::unique_ptr<live::Live> live, OpenRecording open, int port)
    : parts_(std::make_unique<Parts>(port, std::move(live), std::move(open))) {}
Server::Server(std::unique_ptr<Intake> intake, OpenFiles open, int port)
    : parts_(std::make_unique<Parts>(port, std::move(intake), std::move(open))) {}
Server::Server(std::unique_ptr<ResultsView> results, OpenFiles open, int port)
    : parts_(std::make_unique<Parts>(port, std::move(results), std::move(open))) {}
Server::~Server() = default;

std::string Server::address() const { return parts_->guard.address(); }
int Server::port() const { return parts_->port; }

void Server::run() {
  if (!parts_->http.listen_after_bind()) throw std::runtime_error("the port was lost");
}

void Server::stop() {
  parts_->stage.leave();
  parts_->is_to_stop = true;
  if (parts_->listens) parts_->stop_once();
}

}  // namespace offnominal::desk::studio
