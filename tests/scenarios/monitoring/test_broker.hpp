#pragma once

#include "engine/io/broker_client.hpp"
#include "tests/temporary_directory.hpp"

#include <atomic>
#include <string>
#include <sys/types.h>
#include <thread>
#include <vector>

namespace bris::testing {

/// A broker of its own on a free port of the loopback: mosquitto with the users model, rocks and
/// page, who may each read and write their own topics. Ends with the object.
class TestBroker {
public:
    enum class Kind {
        mosquitto,
        with_tls, ///< mosquitto, with TLS and the certificate in folder()/server.pem
        silent,   ///< accepts connections and never answers
        absent    ///< does not even accept: as an address behind a firewall, or of no machine
    };
    explicit TestBroker(Kind kind = Kind::mosquitto);
    ~TestBroker();
    TestBroker(const TestBroker&) = delete;

    void start();
    void stop();
    /// Makes the authorities right.pem and wrong.pem, and server.pem for a host; a negative number
    /// of days: it has expired. Before `start`.
    static void make_certificates(const std::filesystem::path& folder, const std::string& host,
                                  int days);
    /// False, with a message, if mosquitto is not installed or this build has no client.
    bool runs() const { return process_ > 0; }
    std::string address() const;
    BrokerSettings settings(const std::string& user) const;
    std::filesystem::path folder() const { return folder_.path(); }

    int port() const { return port_; }

private:
    TemporaryDirectory folder_;
    int port_ = 0, listener_ = -1;
    std::vector<int> waiting_; // connections that fill the queue of the listener
    pid_t process_ = 0;
};

/// A link to a port of the loopback that can be cut.
class TestLink {
public:
    explicit TestLink(int to);
    ~TestLink();
    std::string address() const;
    /// Ends all connections and refuses new ones, or not any more.
    void cut(bool is_cut) { is_cut_ = is_cut; }

private:
    void run();
    int to_, port_ = 0, listener_ = -1;
    std::atomic<bool> is_cut_ = false, ends_ = false;
    std::thread thread_;
};

} // namespace bris::testing
