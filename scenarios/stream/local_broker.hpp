#pragma once

#include "engine/child_program.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace bris {

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
