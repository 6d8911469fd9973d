#pragma once

#include "engine/io/broker_link.hpp"
#include "engine/io/signs_of_life.hpp"
#include "engine/options.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace bris {

/// Connection to an MQTT broker.
struct BrokerSettings {
    std::string address; ///< HOST:PORT; empty: no broker
    std::string user;    ///< empty: the client gives no name
    std::filesystem::path password_file, ca_file;
    double timeout = 10;      ///< s to wait for the first answer
    double absence = 86400;   ///< s for which the broker keeps messages while the client is away
    std::string session = {}; ///< name under which it keeps them; empty: one of this client's own
    std::string run = {};     ///< name under which the client gives signs of life; empty: none
    bool plain = false;       ///< the password may be sent without TLS

    /// Throws InputError for an address that is none, a password without a user, and one that would
    /// leave this computer unencrypted without `plain`.
    void check() const;
    /// The first line of the password's file; empty: there is none. Throws InputError, OutputError.
    std::string password() const;

    void declare_options(auto& option) {
        option("broker", address, "",
               "MQTT broker HOST:PORT from which records are received and to which results are "
               "published. Empty: no broker.");
        option("broker_user", user, "", "User name for the broker. Empty: none is given.");
        option("broker_password_file", password_file, "",
               "File with the password for the broker in its first line. It needs --broker-user; "
               "to another computer it is only sent with TLS or --broker-plain.");
        option("broker_plain", plain, "",
               "Send the password without TLS to a broker on another computer. Everybody on the "
               "way can read it.");
        option("broker_ca_file", ca_file, "",
               "Certificates (PEM) of the authorities that sign the broker's certificate. The "
               "connection is encrypted with TLS if it is given.");
        option("broker_timeout", timeout, "s", "Time to wait for the broker's first answer.",
               within(0.1, 3600));
        option("broker_absence", absence, "s",
               "Time for which the broker is asked to keep records while the connection is broken.",
               within(0, 4e9));
    }
};

/// Client of an MQTT broker (version 5, libmosquitto). A separate thread receives the messages of
/// the subscribed topics, stamps them with the time of arrival and queues them; a full queue drops
/// its oldest. Messages that were sent to the broker with confirmation (QoS 1) come in the order in
/// which they were sent. After a break the client connects again, and gets those that the broker
/// kept meanwhile (`BrokerSettings::absence`); it sends again what the broker has not confirmed,
/// and the retained messages, since a broker may restart without them.
///
/// A broker that does not want this client, as it says (another client has taken the session over,
/// wrong password, not authorised, banned, moved, subscription refused ...), is left alone: then
/// `next` throws OutputError after the last message, and a client without topics says so once.
class BrokerClient : public BrokerLink {
public:
    static constexpr std::size_t largest = 1 << 16;     ///< bytes of a received message
    static constexpr std::size_t queue_bytes = 1 << 26; ///< of all messages that wait
    static constexpr std::size_t most_unsent = 1000;    ///< messages that wait to be confirmed

    enum class Start {
        answered, ///< only a broker that answers in time will do
        any       ///< without an answer in time the client goes on trying; see `problem`
    };
    /// Connects. `name`: beginning of the client's identifier. Throws InputError for a bad address
    /// or password file, OutputError if the broker does not answer within the timeout, is not there
    /// or refuses the client, and if this build has no broker client.
    BrokerClient(const BrokerSettings& settings, const std::string& name,
                 const std::vector<std::string>& topics, Start start = Start::answered);
    /// Ends the session too, unless its name was given: then the broker keeps what arrives.
    ~BrokerClient() override;

    /// Throws OutputError with the broker's final answer.
    std::optional<BrokerMessage> next(double timeout) override;
    /// While there is no connection, messages of at_least_once wait; others are not sent, but the
    /// last retained one of each topic is sent after the break.
    bool publish(const std::string& topic, const std::string& payload, Delivery delivery) override;
    /// Waits at most `timeout` (s) until all messages are sent.
    void flush(double timeout);
    /// The broker is to forget the session with the end of this client.
    void end_session();
    bool connected() const;
    /// What is wrong with the connection, in one line with its address; empty: nothing.
    std::string problem() const;
    BrokerCounters counters() const override;
    /// What the run says of itself; null if it has no name.
    SignsOfLife* signs_of_life();

private:
    struct Connection;
    std::shared_ptr<Connection> connection_; // with the thread of the connection
};

/// Whether this build has a broker client.
bool has_broker_client();

/// The host and the port of "HOST:PORT", also "[IPv6]:PORT". Throws InputError.
std::pair<std::string, int> host_and_port(const std::string& address);

} // namespace bris
