#pragma once

#include "engine/io/broker_client.hpp"
#include "tests/temporary_directory.hpp"

#include <string>
#include <sys/types.h>

namespace bris::testing {

/// A broker of its own on a free port of the loopback: mosquitto with the users model, rocks and
/// page, who may each read and write their own topics. Ends with the object.
class TestBroker {
public:
    enum class Kind {
        mosquitto,
        silent ///< accepts connections and never answers
    };
    explicit TestBroker(Kind kind = Kind::mosquitto);
    ~TestBroker();
    TestBroker(const TestBroker&) = delete;

    void start();
    void stop();
    /// False, with a message, if mosquitto is not installed or this build has no client.
    bool runs() const { return process_ > 0; }
    std::string address() const;
    BrokerSettings settings(const std::string& user) const;
    std::filesystem::path folder() const { return folder_.path(); }

private:
    TemporaryDirectory folder_;
    int port_ = 0, listener_ = -1;
    pid_t process_ = 0;
};

} // namespace bris::testing
