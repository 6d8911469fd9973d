#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <sys/types.h>
#include <vector>

namespace bris {

/// A program in a process of its own, in the process group of this one. SIGTERM ends it with the
/// object.
class ChildProgram {
public:
    /// Throws OutputError if it cannot be started.
    explicit ChildProgram(const std::vector<std::string>& words);
    ~ChildProgram();
    ChildProgram(const ChildProgram&) = delete;
    /// Whether it still runs.
    bool runs();
    /// Exit code of the ended program; -1: a signal ended it, or it still runs.
    int exit_code() const { return code_; }

private:
    pid_t id_ = 0;
    int code_ = -1;
};

/// Where a broker listens, and what it serves.
struct LocalBrokerSettings {
    std::filesystem::path folder; ///< of the configuration
    std::filesystem::path page;   ///< folder that is served over HTTP
    std::string host = "127.0.0.1";
    int port = 0; ///< of the page and of websockets; 0: a free one
};

/// mosquitto for one computer: MQTT on a free port of the loopback, and websockets and the page on
/// another one. Only a host beyond the loopback has to be given by name.
class LocalBroker {
public:
    /// Throws OutputError if mosquitto is not installed or does not answer.
    explicit LocalBroker(const LocalBrokerSettings& settings);
    std::string address() const; ///< HOST:PORT for MQTT
    std::string page() const;    ///< URL
    bool runs() { return program_->runs(); }

private:
    std::string host_;
    int port_ = 0, page_port_ = 0;
    std::unique_ptr<ChildProgram> program_;
};

} // namespace bris
