#pragma once

#include <memory>
#include <string>

#include "studio/stage.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// Serves one session's page to this machine alone: 127.0.0.1, under an address with a token.
class Server {
 public:
  /// Takes a port of 127.0.0.1, any free one for 0, and lets nobody in yet. Throws InputError where
  /// the port is taken, or where the recordings and the robot do not fit together.
  Server(Input input, int port);
  /// The same of a live view, which hands stretches over to a session by `open`.
  Server(std::unique_ptr<live::Live> live, OpenRecording open, int port);
  /// The same of files that the page is given, which become a session by `open`.
  Server(std::unique_ptr<Intake> intake, OpenFiles open, int port);
  /// The same of results of many runs, which become a session by `open`.
  Server(std::unique_ptr<ResultsView> results, OpenFiles open, int port);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  /// After run() has returned, or where it was never called.
  ~Server();

  /// Where the page is, the token in it: "http://127.0.0.1:40123/9f.../".
  [[nodiscard]] std::string address() const;
  [[nodiscard]] int port() const;
  /// Serves until stop(), which may have been called before. Throws std::runtime_error where the
  /// port is lost.
  void run();
  /// From any thread, not from a signal handler: lets what is being answered be answered, stops the
  /// search in the background, and run() returns.
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace offnominal::desk::studio
