#include "engine/io/broker_client.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/json_numbers.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#ifdef BRIS_MOSQUITTO
#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <mutex>
#include <thread>
#include <unistd.h>
#endif

namespace bris {

std::pair<std::string, int> host_and_port(const std::string& address) {
    const auto colon = address.rfind(':');
    std::string host = address.substr(0, colon == std::string::npos ? 0 : colon);
    if (host.size() > 1 && host.front() == '[' && host.back() == ']')
        host = host.substr(1, host.size() - 2);
    const auto port =
        colon == std::string::npos ? std::nullopt : number_of(address.substr(colon + 1));
    if (host.empty() || !port || !(*port >= 1 && *port <= 65535) || std::floor(*port) != *port)
        throw InputError(
            fmt::format("--broker: expected HOST:PORT, found \"{}\"", beginning_of(address)));
    return {host, static_cast<int>(*port)};
}

#ifndef BRIS_MOSQUITTO

bool has_broker_client() { return false; }

struct BrokerClient::Connection {};

BrokerClient::BrokerClient(const BrokerSettings&, const std::string&,
                           const std::vector<std::string>&) {
    throw OutputError("--broker: this build has no broker client; install libmosquitto-dev and "
                      "build again");
}
BrokerClient::~BrokerClient() = default;
std::optional<BrokerMessage> BrokerClient::next(double) { return {}; }
void BrokerClient::publish(const std::string&, const std::string&, Delivery) {}
void BrokerClient::flush(double) {}
bool BrokerClient::connected() const { return false; }
BrokerCounters BrokerClient::counters() const { return {}; }

#else

bool has_broker_client() { return true; }

namespace {

constexpr auto glance = std::chrono::milliseconds(20); // interval between checks for a stop

std::string password_in(const std::filesystem::path& file) {
    std::string text = read_whole(file);
    text.resize(std::min(text.size(), text.find_first_of("\r\n")));
    require(!text.empty(),
            fmt::format("{}:1: expected a password, found an empty line", file.string()));
    return text;
}

} // namespace

struct BrokerClient::Connection {
    std::string address;
    std::vector<std::string> topics;
    mosquitto* client = nullptr;
    mutable std::mutex mutex; // of all below; never held while the library is called
    std::condition_variable came;
    std::deque<BrokerMessage> queue;
    std::size_t bytes = 0;
    std::map<std::string, std::string> retained; // last payload of each topic
    BrokerCounters counters;
    std::size_t unsent = 0;
    bool is_connected = false, was_connected = false;
    int answer = -1; // of the broker to the first connection

    Connection(const BrokerSettings& settings, const std::string& name,
               std::vector<std::string> subscribed)
        : address(settings.address), topics(std::move(subscribed)) {
        const auto [host, port] = host_and_port(settings.address);
        const std::string password =
            settings.password_file.empty() ? "" : password_in(settings.password_file);
        static const int started = mosquitto_lib_init();
        (void)started;
        client = mosquitto_new(fmt::format("{}-{}-{}", name, getpid(), next_number()++).c_str(),
                               true, this);
        if (client == nullptr) throw OutputError("--broker: cannot create a client");
        mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
        mosquitto_reconnect_delay_set(client, 1, 8, true);
        if (!settings.user.empty())
            mosquitto_username_pw_set(client, settings.user.c_str(),
                                      password.empty() ? nullptr : password.c_str());
        if (!settings.ca_file.empty()) {
            (void)read_whole(settings.ca_file); // a clear message if it cannot be read
            if (const int rc = mosquitto_tls_set(client, settings.ca_file.c_str(), nullptr, nullptr,
                                                 nullptr, nullptr);
                rc != MOSQ_ERR_SUCCESS)
                fail(mosquitto_strerror(rc));
        }
        set_callbacks();
        connect(host, port, settings.timeout);
    }
    ~Connection() { close(); }

    static std::atomic<unsigned>& next_number() {
        static std::atomic<unsigned> number = 0;
        return number;
    }
    void close() {
        if (client == nullptr) return;
        mosquitto_disconnect(client);
        mosquitto_loop_stop(client, true);
        mosquitto_destroy(client);
        client = nullptr;
    }
    [[noreturn]] void fail(const std::string& why) {
        close();
        throw OutputError(fmt::format("--broker: {}: {}", address, why));
    }
    void connect(const std::string& host, int port, double timeout) {
        mosquitto_property* limits = nullptr; // a larger message is dropped by the broker
        mosquitto_property_add_int32(&limits, MQTT_PROP_MAXIMUM_PACKET_SIZE,
                                     static_cast<std::uint32_t>(2 * largest));
        const int rc = mosquitto_connect_bind_v5(client, host.c_str(), port, 20, nullptr, limits);
        mosquitto_property_free_all(&limits);
        if (rc == MOSQ_ERR_ERRNO) fail(std::strerror(errno));
        if (rc != MOSQ_ERR_SUCCESS) fail(mosquitto_strerror(rc));
        mosquitto_loop_start(client);
        const Instant began = this_instant();
        std::unique_lock lock(mutex);
        while (answer < 0 && seconds_since(began) < timeout && !interrupted())
            came.wait_for(lock, glance);
        const int got = answer;
        lock.unlock();
        if (got < 0) fail(fmt::format("expected an answer, found none within {:g} s", timeout));
        if (got > 0)
            fail(fmt::format("the broker refused the client: {}", mosquitto_reason_string(got)));
    }
    void set_callbacks() {
        mosquitto_connect_v5_callback_set(
            client, [](mosquitto*, void* self, int code, int, const mosquitto_property*) {
                static_cast<Connection*>(self)->on_connect(code);
            });
        mosquitto_disconnect_v5_callback_set(
            client, [](mosquitto*, void* self, int, const mosquitto_property*) {
                static_cast<Connection*>(self)->on_disconnect();
            });
        mosquitto_message_callback_set(
            client, [](mosquitto*, void* self, const mosquitto_message* message) {
                static_cast<Connection*>(self)->on_message(*message);
            });
        mosquitto_publish_v5_callback_set(
            client, [](mosquitto*, void* self, int, int code, const mosquitto_property*) {
                static_cast<Connection*>(self)->on_publish(code);
            });
    }
    void on_connect(int code) {
        std::map<std::string, std::string> again;
        {
            const std::lock_guard lock(mutex);
            answer = code;
            is_connected = code == 0;
            unsent = 0;
            if (is_connected && was_connected) again = retained;
            was_connected |= is_connected;
            came.notify_all();
        }
        if (code != 0) return;
        for (const std::string& topic : topics)
            mosquitto_subscribe(client, nullptr, topic.c_str(), 1);
        for (const auto& [topic, payload] : again) send(topic, payload, true);
    }
    void on_disconnect() {
        const std::lock_guard lock(mutex);
        counters.breaks += static_cast<std::uint64_t>(is_connected);
        is_connected = false;
        came.notify_all();
    }
    void on_message(const mosquitto_message& message) {
        const std::lock_guard lock(mutex);
        ++counters.received;
        const auto size = static_cast<std::size_t>(message.payloadlen);
        if (size > largest) {
            ++counters.too_large;
            return;
        }
        queue.push_back({message.topic,
                         std::string(static_cast<const char*>(message.payload), size),
                         message.retain, this_instant()});
        bytes += size + queue.back().topic.size() + sizeof(BrokerMessage);
        while (bytes > queue_bytes) {
            forget_first();
            ++counters.dropped;
        }
        came.notify_all();
    }
    void forget_first() {
        const BrokerMessage& first = queue.front();
        bytes -= first.payload.size() + first.topic.size() + sizeof(BrokerMessage);
        queue.pop_front();
    }
    void on_publish(int code) {
        const std::lock_guard lock(mutex);
        if (unsent > 0) --unsent;
        counters.refused += static_cast<std::uint64_t>(code >= 128);
        came.notify_all();
    }
    void send(const std::string& topic, const std::string& payload, bool keep) {
        {
            const std::lock_guard lock(mutex);
            if (!is_connected || unsent >= most_unsent) {
                ++counters.unpublished;
                return;
            }
            ++unsent;
        }
        const int rc =
            mosquitto_publish_v5(client, nullptr, topic.c_str(), static_cast<int>(payload.size()),
                                 payload.data(), keep ? 1 : 0, keep, nullptr);
        const std::lock_guard lock(mutex);
        if (rc == MOSQ_ERR_SUCCESS) {
            ++counters.published;
        } else {
            ++counters.unpublished;
            if (unsent > 0) --unsent;
        }
    }
};

BrokerClient::BrokerClient(const BrokerSettings& settings, const std::string& name,
                           const std::vector<std::string>& topics)
    : connection_(std::make_unique<Connection>(settings, name, topics)) {}
BrokerClient::~BrokerClient() = default;

std::optional<BrokerMessage> BrokerClient::next(double timeout) {
    Connection& c = *connection_;
    const Instant began = this_instant();
    std::unique_lock lock(c.mutex);
    while (c.queue.empty() && !interrupted() && seconds_since(began) < timeout)
        c.came.wait_for(lock, glance);
    if (c.queue.empty()) return {};
    BrokerMessage message = c.queue.front();
    c.forget_first();
    return message;
}

void BrokerClient::publish(const std::string& topic, const std::string& payload,
                           Delivery delivery) {
    const bool keep = delivery == Delivery::retained;
    if (keep) {
        const std::lock_guard lock(connection_->mutex);
        connection_->retained[topic] = payload;
    }
    connection_->send(topic, payload, keep);
}

void BrokerClient::flush(double timeout) {
    Connection& c = *connection_;
    const Instant began = this_instant();
    std::unique_lock lock(c.mutex);
    while (c.unsent > 0 && c.is_connected && seconds_since(began) < timeout)
        c.came.wait_for(lock, glance);
}

bool BrokerClient::connected() const {
    const std::lock_guard lock(connection_->mutex);
    return connection_->is_connected;
}

BrokerCounters BrokerClient::counters() const {
    const std::lock_guard lock(connection_->mutex);
    return connection_->counters;
}

#endif

} // namespace bris
