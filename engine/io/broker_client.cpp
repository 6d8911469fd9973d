#include "engine/io/broker_client.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/arrival.hpp"
#include "engine/io/message_queue.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/printable.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#ifdef BRIS_MOSQUITTO
#include "engine/io/mqtt_packets.hpp"
#include "engine/message.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <mosquitto.h>
#include <mutex>
#include <poll.h>
#include <span>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#endif

namespace bris {

#ifndef BRIS_MOSQUITTO

bool has_broker_client() { return false; }

struct BrokerClient::Connection {};

BrokerClient::BrokerClient(const BrokerSettings&, const std::string&,
                           const std::vector<std::string>&, Start) {
    throw OutputError("--broker: this build has no broker client; install libmosquitto-dev and "
                      "build again");
}
BrokerClient::~BrokerClient() = default;
std::optional<BrokerMessage> BrokerClient::next(double) { return {}; }
bool BrokerClient::publish(const std::string&, const std::string&, Delivery) { return false; }
void BrokerClient::flush(double) {}
void BrokerClient::end_session() {}
bool BrokerClient::connected() const { return false; }
std::string BrokerClient::problem() const { return {}; }
BrokerCounters BrokerClient::counters() const { return {}; }
SignsOfLife* BrokerClient::signs_of_life() { return nullptr; }

#else

bool has_broker_client() { return true; }

namespace {

using Delivery = BrokerLink::Delivery;

constexpr auto glance = std::chrono::milliseconds(20); // interval between checks for a stop
constexpr int loop_ms = 100;                           // in which the library looks for a stop
constexpr double shortest_wait = 1, longest_wait = 8;  // s, before connecting again
constexpr double farewell = 2;           // s that the thread of a connection has for its end
constexpr int keep_alive = 20;           // s
constexpr std::size_t thrown_out = 4;    // breaks of a named session within so many seconds that
constexpr double thrown_out_within = 15; // say that another client has it

} // namespace

/// The connection and the thread that runs it. The library waits for minutes for an address that
/// never answers, and for ever for a TLS handshake: the thread owns the connection as well, so that
/// nobody else has to wait for it.
struct BrokerClient::Connection {
    const BrokerSettings settings;
    const std::string host, name;
    const int port;
    std::vector<std::string> topics;
    bool tells_of_itself = false; // own_topic is subscribed
    mosquitto* client = nullptr;
    std::optional<SignsOfLife> life;

    mutable std::mutex mutex; // of all below; never held while the library is called
    std::condition_variable came;
    MessageQueue queue{queue_bytes};
    std::map<std::string, std::string> retained;             // last payload of each topic
    std::deque<std::pair<std::string, std::string>> waiting; // for a connection: topic, payload
    std::map<int, bool> unconfirmed; // id of a message that was sent; whether it is sent again
    std::map<int, bool> early;       // confirmed before its id was known: whether by the broker
    BrokerCounters counters;
    bool is_connected = false, was_connected = false, closing = false, ended = false;
    bool ends_session = false, has_failed = false, was_refused = false;
    bool was_broken = false;          // until the thread has noted it
    bool is_final = false;            // the problem will not go away: the thread ends
    bool is_late = false;             // what waited for the connection is being sent
    std::deque<Instant> breaks;       // the last ones, of a session that has a name
    std::string problem, tls_problem; // of the connection; of the library's log

    Connection(const BrokerSettings& s, std::pair<std::string, int> to, const std::string& program,
               const std::vector<std::string>& subscribed)
        : settings(s), host(std::move(to.first)), name(name_of(s, program)), port(to.second) {
        for (const std::string& topic : subscribed)
            if (topic == own_topic)
                tells_of_itself = true;
            else
                topics.push_back(topic);
        static const int started = mosquitto_lib_init();
        (void)started;
        client = mosquitto_new(name.c_str(), false, this);
        if (client == nullptr) throw OutputError("--broker: cannot create a client");
        if (!settings.run.empty()) life.emplace(settings.run);
    }
    ~Connection() { mosquitto_destroy(client); }

    static std::string name_of(const BrokerSettings& s, const std::string& program) {
        static std::atomic<unsigned> number = 0;
        if (!s.session.empty()) return s.session;
        return fmt::format("{}-{}-{}-{:.0f}", program, getpid(), number++, 1e3 * arrival_now());
    }
    std::string described(const std::string& what) const {
        return fmt::format("--broker: {}: {}", settings.address, what);
    }
    void set_up() {
        mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
        mosquitto_int_option(client, MOSQ_OPT_TCP_NODELAY, 1);
        mosquitto_threaded_set(client, true);
        settings.check();
        const std::string password = settings.password();
        if (!settings.user.empty())
            mosquitto_username_pw_set(client, settings.user.c_str(),
                                      password.empty() ? nullptr : password.c_str());
        if (!settings.ca_file.empty()) {
            (void)read_whole(settings.ca_file); // a clear message if it cannot be read
            if (const int rc = mosquitto_tls_set(client, settings.ca_file.c_str(), nullptr, nullptr,
                                                 nullptr, nullptr);
                rc != MOSQ_ERR_SUCCESS)
                throw OutputError(described(mosquitto_strerror(rc)));
        }
        if (life)
            mosquitto_will_set_v5(client, life->topic_of_will().c_str(),
                                  static_cast<int>(SignsOfLife::will(true).size()),
                                  SignsOfLife::will(true).data(), 1, true, nullptr);
        set_callbacks();
    }
    void set_callbacks() {
        mosquitto_connect_v5_callback_set(client, [](mosquitto*, void* self, int code, int flags,
                                                     const mosquitto_property* more) {
            static_cast<Connection*>(self)->on_connect(code, (flags & 1) != 0, other_broker(more));
        });
        mosquitto_disconnect_v5_callback_set(
            client, [](mosquitto*, void* self, int code, const mosquitto_property*) {
                static_cast<Connection*>(self)->on_disconnect(code);
            });
        mosquitto_subscribe_v5_callback_set(client,
                                            [](mosquitto*, void* self, int, int count,
                                               const int* answers, const mosquitto_property*) {
                                                static_cast<Connection*>(self)->on_subscribe(
                                                    {answers, static_cast<std::size_t>(count)});
                                            });
        mosquitto_message_callback_set(
            client, [](mosquitto*, void* self, const mosquitto_message* message) {
                static_cast<Connection*>(self)->on_message(*message);
            });
        mosquitto_publish_v5_callback_set(
            client, [](mosquitto*, void* self, int id, int code, const mosquitto_property*) {
                static_cast<Connection*>(self)->on_publish(id, code);
            });
        mosquitto_log_callback_set(client, [](mosquitto*, void* self, int level, const char* text) {
            if (level == MOSQ_LOG_ERR) static_cast<Connection*>(self)->on_log(text);
        });
    }

    // of the thread

    /// Connects, and again after a break, until the connection is to be closed or the broker has
    /// said that it does not want this client.
    void run() {
        Properties properties;
        properties.add(MQTT_PROP_MAXIMUM_PACKET_SIZE, 2 * largest); // larger: the broker drops it
        properties.add(MQTT_PROP_SESSION_EXPIRY_INTERVAL,
                       static_cast<std::uint32_t>(settings.absence));
        int rc = mosquitto_connect_bind_v5(client, host.c_str(), port, keep_alive, nullptr,
                                           properties.get());
        for (double wait = shortest_wait;; wait = std::min(2 * wait, longest_wait)) {
            while (rc == MOSQ_ERR_SUCCESS && !is_over()) {
                rc = mosquitto_loop(client, loop_ms, 1);
                give_sign_of_life();
            }
            const int error = errno;
            if (is_over()) break;
            if (note_failure(rc, error)) wait = shortest_wait;
            const Instant since = this_instant();
            while (seconds_since(since) < wait && !is_over()) std::this_thread::sleep_for(glance);
            if (is_over()) break;
            rc = mosquitto_reconnect(client);
        }
        say_farewell();
        const std::lock_guard lock(mutex);
        ended = true;
        has_failed |= is_final;
        if (is_final && was_connected && topics.empty()) // nobody waits for a message
            say(problem + "; the run goes on without the broker");
        came.notify_all();
    }
    bool is_over() const {
        const std::lock_guard lock(mutex);
        return closing || is_final;
    }
    void give_up(const std::string& why) { // the mutex is held
        is_final = true;
        is_connected = false;
        problem = described(fmt::format("{} (client \"{}\")", why, name));
    }
    void give_sign_of_life() {
        if (!life || !life->is_due()) return;
        {
            const std::lock_guard lock(mutex);
            if (!is_connected) return;
        }
        (void)publish_now(life->topic(), life->heartbeat(arrival_now()), Delivery::retained);
    }
    void say_farewell() {
        bool connected = false, ends = false;
        {
            const std::lock_guard lock(mutex);
            connected = is_connected;
            ends = ends_session;
        }
        if (!connected) return;
        // The library closes its socket after the farewell. If records waited in the socket then,
        // the system would reset the connection, and the broker might never read the farewell: a
        // copy stays open until the broker has closed its side.
        if (life) {
            const std::string last = life->heartbeat(arrival_now(), true);
            mosquitto_publish_v5(client, nullptr, life->topic().c_str(),
                                 static_cast<int>(last.size()), last.data(), 0, true, nullptr);
        }
        const int copy = dup(mosquitto_socket(client));
        Properties properties;
        if (ends) properties.add(MQTT_PROP_SESSION_EXPIRY_INTERVAL, 0);
        mosquitto_disconnect_v5(client, 0, ends ? properties.get() : nullptr);
        // writes only: from now on the library takes anything that it reads for an error, and would
        // close the connection before the farewell is sent
        const Instant began = this_instant();
        while (mosquitto_want_write(client) && seconds_since(began) < farewell &&
               mosquitto_loop_write(client, 1) == MOSQ_ERR_SUCCESS)
            std::this_thread::yield();
        if (copy < 0) return;
        std::array<char, 4096> rest{};
        for (pollfd input{copy, POLLIN, 0}; seconds_since(began) < farewell;)
            if (poll(&input, 1, loop_ms) > 0 && recv(copy, rest.data(), rest.size(), 0) <= 0) break;
        close(copy);
    }
    /// Keeps what is wrong. Returns whether there was a connection before, which the library has
    /// told on_disconnect.
    bool note_failure(int rc, int error) {
        const std::lock_guard lock(mutex);
        const bool was_refused_now = std::exchange(was_refused, false),
                   was_broken_now = std::exchange(was_broken, false);
        has_failed = true;
        if (was_refused_now || was_broken_now) {
            // what is wrong is known
        } else if (rc == MOSQ_ERR_TLS || !tls_problem.empty() ||
                   (rc == MOSQ_ERR_ERRNO && error == EPROTO)) // of release 2.0.21
            problem = described(fmt::format(
                "no TLS connection with the authorities of '{}': {}", settings.ca_file.string(),
                tls_problem.empty() ? "the other side speaks no TLS" : tls_problem));
        else if (rc == MOSQ_ERR_ERRNO)
            problem = described(std::strerror(error));
        else if (rc == MOSQ_ERR_EAI)
            problem = described(fmt::format("expected the name of a host, found \"{}\"", host));
        else
            problem =
                described(rc == MOSQ_ERR_CONN_LOST
                              ? fmt::format("the broker closed the connection without an answer{}",
                                            settings.ca_file.empty()
                                                ? "; does it expect TLS (--broker-ca-file)?"
                                                : "; does it speak TLS?")
                              : mosquitto_strerror(rc));
        tls_problem.clear();
        came.notify_all();
        return was_broken_now;
    }

    // called by the library

    void on_log(const std::string& text) {
        const std::lock_guard lock(mutex);
        if (text.find("host name") != std::string::npos)
            tls_problem = fmt::format("the broker's certificate is of another host than {}", host);
        else if (text.find("certificate verify failed") != std::string::npos) {
            if (tls_problem.empty())
                tls_problem = "the broker's certificate is not signed by them, has expired, or is "
                              "not valid yet";
        } else if (text.find("SSL") != std::string::npos && tls_problem.empty()) {
            tls_problem = text.substr(text.rfind(':') + 1);
        }
    }
    void on_connect(int code, bool has_session, const std::string& elsewhere) {
        std::map<std::string, std::string> again;
        {
            const std::lock_guard lock(mutex);
            has_failed |= code != 0;
            was_refused = code != 0;
            problem = code == 0 ? ""
                                : described(fmt::format("the broker refused the client: {}",
                                                        mosquitto_reason_string(code)));
            is_connected = code == 0;
            if (const std::string why = final_answer(code); !why.empty()) give_up(why + elsewhere);
            if (is_connected) {
                std::erase_if(unconfirmed, [](const auto& one) { return !one.second; });
                early.clear();
                if (was_connected) again = retained;
                const bool lost = was_connected && !has_session;
                counters.lost_sessions += static_cast<std::uint64_t>(lost);
                tell(lost ? "session lost" : "connected");
            }
            was_connected |= is_connected;
            came.notify_all();
        }
        if (code != 0) return;
        if (!topics.empty()) {
            std::vector<char*> names; // which the library only reads
            for (std::string& topic : topics) names.push_back(topic.data());
            mosquitto_subscribe_multiple(client, nullptr, static_cast<int>(names.size()),
                                         names.data(), 1, MQTT_SUB_OPT_SEND_RETAIN_NEW, nullptr);
        }
        if (life) // not the last will of the run before
            (void)publish_now(life->topic_of_will(), SignsOfLife::will(false), Delivery::retained);
        for (const auto& [topic, payload] : again) send(topic, payload, Delivery::retained);
        send_waiting();
    }
    /// Sends what waited for the connection. What is published meanwhile comes after it.
    void send_waiting() {
        for (bool goes_on = true; goes_on;) {
            std::pair<std::string, std::string> next;
            {
                const std::lock_guard lock(mutex);
                goes_on = is_connected && !waiting.empty();
                is_late = goes_on;
                if (!goes_on) return;
                next = std::move(waiting.front());
                waiting.pop_front();
            }
            (void)publish_now(next.first, next.second, Delivery::at_least_once);
        }
    }
    /// A topic that the broker refuses would be missing without a word.
    void on_subscribe(std::span<const int> answers) {
        const std::lock_guard lock(mutex);
        std::string refused;
        for (std::size_t k = 0; k < std::min(answers.size(), topics.size()); ++k)
            if (answers[k] >= 128)
                refused += fmt::format("{}\"{}\" ({})", refused.empty() ? "" : ", ", topics[k],
                                       mosquitto_reason_string(answers[k]));
        if (refused.empty()) return;
        refused = "the broker refuses the subscription of " + refused;
        if (std::ranges::all_of(answers, [](int answer) { return answer >= 128; }))
            give_up(refused);
        else
            say(described(refused + "; the run goes on without these topics"));
        came.notify_all();
    }
    /// Brokers such as mosquitto 2.0.11 do not say that another client has taken the session over.
    /// Two clients that throw each other out show it: each is back after a second, and loses the
    /// connection a second later. The first one has one break more, so the second one goes on.
    bool is_thrown_out() {                          // the mutex is held
        if (settings.session.empty()) return false; // nobody else has the name
        breaks.push_back(this_instant());
        if (breaks.size() > thrown_out) breaks.pop_front();
        return breaks.size() == thrown_out && seconds_since(breaks.front()) < thrown_out_within;
    }
    void on_disconnect(int code) {
        const std::lock_guard lock(mutex);
        if (!std::exchange(is_connected, false)) return; // there was none
        ++counters.breaks;
        tell("broken");
        problem = described("the connection is broken");
        if (const std::string why = final_answer(code); !why.empty())
            give_up(why);
        else if (is_thrown_out())
            give_up("the broker closed the connection again and again, as when another client has "
                    "taken the session over");
        was_broken = true;
        came.notify_all();
    }
    void tell(const char* what) { // the mutex is held
        if (tells_of_itself) put({own_topic, what});
    }
    void put(BrokerMessage message) { // the same
        message.arrived = this_instant();
        message.time = arrival_now();
        counters.dropped += queue.push(std::move(message));
        came.notify_all();
    }
    void on_message(const mosquitto_message& message) {
        const std::lock_guard lock(mutex);
        ++counters.received;
        const auto size = static_cast<std::size_t>(message.payloadlen);
        if (size > largest)
            ++counters.too_large;
        else
            put({message.topic, std::string(static_cast<const char*>(message.payload), size),
                 message.retain});
    }
    void on_publish(int id, int code) {
        const std::lock_guard lock(mutex);
        counters.refused += static_cast<std::uint64_t>(code >= 128);
        const auto found = unconfirmed.find(id);
        if (found == unconfirmed.end()) {
            early[id] = code < 128;
            return;
        }
        counters.acknowledged += static_cast<std::uint64_t>(found->second && code < 128);
        unconfirmed.erase(found);
        came.notify_all();
    }

    bool send(const std::string& topic, const std::string& payload, Delivery delivery) {
        {
            const std::lock_guard lock(mutex);
            const bool full = unconfirmed.size() + waiting.size() >= most_unsent;
            const bool waits = !is_connected || is_late || !waiting.empty();
            if (waits && !full && delivery == Delivery::at_least_once) {
                waiting.emplace_back(topic, payload);
                return true;
            }
            if (!is_connected || full) {
                ++counters.unpublished;
                return false;
            }
        }
        return publish_now(topic, payload, delivery);
    }
    bool publish_now(const std::string& topic, const std::string& payload, Delivery delivery) {
        const bool confirmed = delivery != Delivery::once_at_most;
        int id = 0;
        const int rc = mosquitto_publish_v5(
            client, &id, topic.c_str(), static_cast<int>(payload.size()), payload.data(),
            confirmed ? 1 : 0, delivery == Delivery::retained, nullptr);
        const std::lock_guard lock(mutex);
        // a message that is to be confirmed is kept by the library and sent after a break
        if (rc != MOSQ_ERR_SUCCESS && !(confirmed && rc == MOSQ_ERR_NO_CONN)) {
            ++counters.unpublished;
            return false;
        }
        ++counters.published;
        if (const auto found = early.find(id); found != early.end()) {
            counters.acknowledged += static_cast<std::uint64_t>(confirmed && found->second);
            early.erase(found);
        } else {
            unconfirmed[id] = confirmed;
        }
        return true;
    }
};

BrokerClient::BrokerClient(const BrokerSettings& settings, const std::string& name,
                           const std::vector<std::string>& topics, Start start)
    : connection_(
          std::make_shared<Connection>(settings, host_and_port(settings.address), name, topics)) {
    Connection& c = *connection_;
    c.set_up();
    std::thread([connection = connection_] { connection->run(); }).detach();
    const Instant began = this_instant();
    std::unique_lock lock(c.mutex);
    // was: a connection that is broken at once is told by `next`, and made again where that helps
    while (!c.was_connected && !c.has_failed && seconds_since(began) < settings.timeout &&
           !interrupted())
        c.came.wait_for(lock, glance);
    if (c.was_connected) return;
    const bool silent = !c.has_failed, asked_to_stop = silent && interrupted();
    if (silent)
        c.problem = c.described(
            fmt::format("expected an answer, found none within {:g} s", settings.timeout));
    if (silent && !asked_to_stop && start == Start::any) return;
    c.closing = true;
    if (asked_to_stop) throw Interrupted("interrupted while the broker was asked for an answer");
    throw OutputError(c.problem);
}

BrokerClient::~BrokerClient() {
    Connection& c = *connection_;
    std::unique_lock lock(c.mutex);
    c.closing = true;
    c.ends_session |= c.settings.session.empty();
    const Instant began = this_instant();
    while (!c.ended && seconds_since(began) < farewell) c.came.wait_for(lock, glance);
}

std::optional<BrokerMessage> BrokerClient::next(double timeout) {
    Connection& c = *connection_;
    if (c.life) c.life->sign();
    const Instant began = this_instant();
    std::unique_lock lock(c.mutex);
    while (c.queue.empty() && !c.is_final && !interrupted() && seconds_since(began) < timeout)
        c.came.wait_for(lock, glance);
    if (!c.queue.empty()) return c.queue.pop();
    if (c.is_final) throw OutputError(c.problem);
    return {};
}

bool BrokerClient::publish(const std::string& topic, const std::string& payload,
                           Delivery delivery) {
    if (connection_->life) connection_->life->sign();
    if (delivery == Delivery::retained) {
        const std::lock_guard lock(connection_->mutex);
        connection_->retained[topic] = payload;
    }
    return connection_->send(topic, payload, delivery);
}

void BrokerClient::flush(double timeout) {
    Connection& c = *connection_;
    const Instant began = this_instant();
    std::unique_lock lock(c.mutex);
    while (!(c.unconfirmed.empty() && c.waiting.empty()) && !c.is_final &&
           seconds_since(began) < timeout)
        c.came.wait_for(lock, glance);
}

SignsOfLife* BrokerClient::signs_of_life() {
    return connection_->life ? &*connection_->life : nullptr;
}

void BrokerClient::end_session() {
    const std::lock_guard lock(connection_->mutex);
    connection_->ends_session = true;
}

bool BrokerClient::connected() const {
    const std::lock_guard lock(connection_->mutex);
    return connection_->is_connected;
}

std::string BrokerClient::problem() const {
    const std::lock_guard lock(connection_->mutex);
    return connection_->problem;
}

BrokerCounters BrokerClient::counters() const {
    const std::lock_guard lock(connection_->mutex);
    return connection_->counters;
}

#endif

} // namespace bris
