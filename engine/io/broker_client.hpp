#pragma once

#include "engine/options.hpp"
#include "engine/stopwatch.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// Connection to an MQTT broker.
struct BrokerSettings {
    std::string address; ///< HOST:PORT; empty: no broker
    std::string user;    ///< empty: the client gives no name
    std::filesystem::path password_file, ca_file;
    double timeout = 10; ///< s to wait for the first answer

    void describe(auto& option) {
        option("broker", address, "",
               "MQTT broker HOST:PORT from which records are received and to which results are "
               "published. Empty: no broker.");
        option("broker_user", user, "", "User name for the broker. Empty: none is given.");
        option("broker_password_file", password_file, "",
               "File with the password for the broker in its first line.");
        option("broker_ca_file", ca_file, "",
               "Certificates (PEM) of the authorities that sign the broker's certificate. The "
               "connection is encrypted with TLS if it is given.");
        option("broker_timeout", timeout, "s", "Time to wait for the broker's first answer.",
               within(0.1, 3600));
    }
};

struct BrokerMessage {
    std::string topic, payload;
    bool retained = false; ///< kept by the broker from before the subscription
    Instant arrived;
};

/// What a client counts.
struct BrokerCounters {
    std::uint64_t received = 0, published = 0;
    std::uint64_t dropped = 0;     ///< received, but the queue was full: the oldest ones
    std::uint64_t too_large = 0;   ///< received, but longer than `largest`
    std::uint64_t unpublished = 0; ///< not sent: no connection, or too many wait to be sent
    std::uint64_t refused = 0;     ///< published, but refused by the broker
    std::uint64_t breaks = 0;      ///< of the connection
};

/// Client of an MQTT broker (version 5, libmosquitto). A separate thread receives the messages of
/// the subscribed topics, stamps them with the time of arrival and queues them; a full queue drops
/// its oldest. After a break it connects and subscribes again, and publishes the retained messages
/// again, since a broker may restart without them.
class BrokerClient {
public:
    static constexpr std::size_t largest = 1 << 16;     ///< bytes of a received message
    static constexpr std::size_t queue_bytes = 1 << 26; ///< of all messages that wait
    static constexpr std::size_t most_unsent = 1000;    ///< messages that wait to be sent

    /// Connects. `name`: beginning of the client's identifier. Throws InputError for a bad address
    /// or password file, OutputError if the broker does not answer within the timeout or refuses
    /// the client, and if this build has no broker client.
    BrokerClient(const BrokerSettings& settings, const std::string& name,
                 const std::vector<std::string>& topics);
    ~BrokerClient();

    /// The next message; waits at most `timeout` (s). Nothing: none came, or the user stops the
    /// run.
    std::optional<BrokerMessage> next(double timeout);
    enum class Delivery { once_at_most, retained };
    /// Publishes; never waits. Retained messages are acknowledged by the broker, and the last one
    /// of each topic is published again after a break.
    void publish(const std::string& topic, const std::string& payload, Delivery delivery);
    /// Waits at most `timeout` (s) until all messages are sent.
    void flush(double timeout);
    bool connected() const;
    BrokerCounters counters() const;

private:
    struct Connection;
    std::unique_ptr<Connection> connection_;
};

/// Whether this build has a broker client.
bool has_broker_client();

/// The host and the port of "HOST:PORT", also "[IPv6]:PORT". Throws InputError.
std::pair<std::string, int> host_and_port(const std::string& address);

} // namespace bris
