// What a broker answers, by a broker of this test that says one thing to every client.
#include "engine/errors.hpp"
#include "engine/io/broker_client.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/stopwatch.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <netinet/in.h>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

using namespace bris;

namespace {

using Bytes = std::vector<std::uint8_t>;

/// Gives every client the same answers: to its CONNECT, and then, if it has subscribed something,
/// to its SUBSCRIBE. It closes no connection.
class OneAnswer {
public:
    OneAnswer(Bytes to_connect, Bytes to_subscribe)
        : to_connect_(std::move(to_connect)), to_subscribe_(std::move(to_subscribe)) {
        listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        REQUIRE(bind(listener_, reinterpret_cast<sockaddr*>(&address), size) == 0);
        REQUIRE(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0);
        REQUIRE(listen(listener_, 8) == 0);
        port_ = ntohs(address.sin_port);
        thread_ = std::thread([this] { run(); });
    }
    ~OneAnswer() {
        ends_ = true;
        thread_.join();
        for (const int s : clients_) close(s);
        close(listener_);
    }
    OneAnswer(const OneAnswer&) = delete;

    BrokerSettings settings() const {
        BrokerSettings s;
        s.address = fmt::format("127.0.0.1:{}", port_);
        s.session = "site 7";
        return s;
    }
    unsigned connections() const { return connections_; }

private:
    void run() {
        while (!ends_) {
            std::vector<pollfd> waits{{listener_, POLLIN, 0}};
            for (const int s : clients_) waits.push_back({s, POLLIN, 0});
            (void)poll(waits.data(), waits.size(), 10);
            for (std::size_t k = 1; k < waits.size(); ++k)
                if (waits[k].revents != 0) answer(waits[k].fd);
            std::erase(clients_, -1);
            if (waits[0].revents == 0) continue;
            clients_.push_back(accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC));
            ++connections_;
        }
    }
    void answer(int client) {
        std::array<std::uint8_t, 1 << 12> packet{};
        const ssize_t size = read(client, packet.data(), packet.size());
        if (size <= 0) {
            close(client);
            std::ranges::replace(clients_, client, -1);
            return;
        }
        if (packet[0] == 0x10) send(client, to_connect_);
        if (packet[0] != 0x82) return;
        Bytes all = to_subscribe_;
        if (all.size() > 3 && all[0] == 0x90) { // SUBACK has the number of the packet
            all[2] = packet[2];
            all[3] = packet[3];
        }
        send(client, all);
    }
    static void send(int client, const Bytes& bytes) {
        if (!bytes.empty()) (void)!write(client, bytes.data(), bytes.size());
    }

    Bytes to_connect_, to_subscribe_;
    int listener_ = -1, port_ = 0;
    std::vector<int> clients_; // of the thread
    std::atomic<unsigned> connections_ = 0;
    std::atomic<bool> ends_ = false;
    std::thread thread_;
};

Bytes connack(std::uint8_t code) { return {0x20, 3, 0, code, 0}; }
Bytes disconnect(std::uint8_t code) { return {0xe0, 2, code, 0}; }

/// What `next` throws within some seconds; empty: nothing.
std::string end_of(BrokerClient& client, double seconds = 5) {
    const Instant began = this_instant();
    try {
        while (seconds_since(began) < seconds) (void)client.next(0.1);
    } catch (const OutputError& e) {
        return e.what();
    }
    return {};
}

std::string refusal_of(const BrokerSettings& settings) {
    try {
        const BrokerClient client(settings, "client", {"a"});
    } catch (const OutputError& e) {
        return e.what();
    }
    return {};
}

bool contains(const std::string& text, const std::string& part) {
    CAPTURE(text);
    CAPTURE(part);
    const bool found = text.find(part) != std::string::npos;
    CHECK(found);
    return found;
}

} // namespace

TEST_SUITE("engine/io/broker_client") {
    TEST_CASE("a client that the broker sends away for good ends in one line, and does not connect "
              "again") {
        if (!has_broker_client()) return;
        struct Answer {
            std::uint8_t code;
            const char* text;
        };
        for (const auto& [code, text] : {Answer{0x8e, "another client has taken the session over"},
                                         {0x87, "not authorised"},
                                         {0x8a, "Banned"},
                                         {0x98, "an administrator"},
                                         {0x9c, "another server"},
                                         {0x9d, "moved"}}) {
            CAPTURE(code);
            OneAnswer broker(connack(0), disconnect(code));
            BrokerClient client(broker.settings(), "client", {"a"});
            const std::string end = end_of(client);
            CHECK(contains(end, "--broker: 127.0.0.1:"));
            CHECK(contains(end, text));
            CHECK(contains(end, "\"site 7\""));
            CHECK(end_of(client, 1.5) == end); // later the same
            CHECK(broker.connections() == 1);
        }
    }

    TEST_CASE("a client that cannot come in is told why, once") {
        if (!has_broker_client()) return;
        struct Answer {
            std::uint8_t code;
            const char* text;
        };
        for (const auto& [code, text] : {Answer{0x86, "the user name or the password"},
                                         {0x87, "not authorised"},
                                         {0x8a, "Banned"},
                                         {0x85, "the client's name"},
                                         {0x84, "version 5"},
                                         {1, "version 5"},
                                         {4, "the user name or the password"},
                                         {5, "not authorised"}}) {
            CAPTURE(code);
            OneAnswer broker(connack(code), {});
            CHECK(contains(refusal_of(broker.settings()), text));
            CHECK(broker.connections() == 1);
        }
    }

    TEST_CASE("a client that was sent away for a while comes again") {
        if (!has_broker_client()) return;
        for (const int code : {0x89, 0x8b, 0x8d, 0x97}) { // busy, ends, silent, quota
            CAPTURE(code);
            OneAnswer broker(connack(0), disconnect(static_cast<std::uint8_t>(code)));
            BrokerClient client(broker.settings(), "client", {"a"});
            CHECK(end_of(client, 1.5).empty());
            CHECK(broker.connections() >= 2);
        }
    }

    TEST_CASE("where another broker is named, the line names it") {
        if (!has_broker_client()) return;
        const std::string name = "b.example:8883"; // as a property of the CONNACK
        const auto size = static_cast<std::uint8_t>(name.size());
        Bytes moved{0x20,
                    static_cast<std::uint8_t>(6 + size),
                    0,
                    0x9d,
                    static_cast<std::uint8_t>(3 + size),
                    0x1c,
                    0,
                    size};
        moved.insert(moved.end(), name.begin(), name.end());
        OneAnswer broker(moved, {});
        CHECK(contains(refusal_of(broker.settings()), "it names \"b.example:8883\""));
    }

    TEST_CASE("refused topics: the run ends if no topic is left, and says so otherwise") {
        if (!has_broker_client()) return;
        for (const bool all : {true, false}) {
            const std::uint8_t second = all ? 0x87 : 0x01;
            OneAnswer broker(connack(0), {0x90, 5, 0, 0, 0, 0x87, second});
            BrokerClient client(broker.settings(), "client", {"of/sensors", "of/machine"});
            const std::string end = end_of(client, all ? 5 : 1);
            CHECK(end.empty() == !all);
            if (all) CHECK(contains(end, "refuses the subscription of \"of/sensors\""));
            CHECK(client.connected() == !all);
        }
    }

    TEST_CASE("a password goes to another computer with TLS only, and not without a user") {
        const TemporaryDirectory folder;
        write_whole(folder / "password", "secret\n");
        BrokerSettings s;
        s.user = "model";
        s.password_file = folder / "password";
        for (const char* here : {"localhost:1883", "127.0.0.1:1", "127.3.2.1:1", "[::1]:1883"}) {
            CAPTURE(here);
            s.address = here;
            CHECK_NOTHROW(s.check());
        }
        for (const char* away : {"b.example:1883", "10.0.0.1:1883", "[fe80::1]:1883", "128.0.0.1:1",
                                 "localhost.b.example:1883"}) {
            CAPTURE(away);
            s.address = away;
            CHECK_THROWS_AS(s.check(), InputError);
            CHECK_THROWS_AS(BrokerClient(s, "client", {}), InputError); // before it connects
            s.plain = true;
            CHECK_NOTHROW(s.check());
            s.plain = false;
            s.ca_file = "ca.pem";
            CHECK_NOTHROW(s.check());
            s.ca_file.clear();
        }
        s.address = "localhost:1883";
        s.user.clear();
        CHECK_THROWS_WITH(s.check(),
                          "--broker-password-file: expected --broker-user too, found none");
    }
}
