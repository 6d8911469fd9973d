#include "scenarios/stream/local_broker.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/stopwatch.hpp"

#include <fmt/format.h>

#include <arpa/inet.h>
#include <chrono>
#include <netinet/in.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace bris {

namespace {

constexpr auto glance = std::chrono::milliseconds(20);
constexpr double answer_time = 5; // s, in which a broker answers
constexpr int attempts = 5;       // another program may take a port that was free

sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

int free_port() {
    const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    const bool bound = s >= 0 && bind(s, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                       getsockname(s, reinterpret_cast<sockaddr*>(&address), &size) == 0;
    if (s >= 0) close(s);
    if (!bound) throw OutputError("broker: cannot find a free port");
    return ntohs(address.sin_port);
}

bool answers(int port) {
    const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_in address = loopback(port);
    const bool connected =
        connect(s, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    close(s);
    return connected;
}

std::string installed_broker() {
    for (const char* path : {"/usr/sbin/mosquitto", "/usr/local/sbin/mosquitto"})
        if (access(path, X_OK) == 0) return path;
    throw OutputError("broker: expected the program mosquitto, found none; install the Debian "
                      "package mosquitto");
}

} // namespace

LocalBroker::LocalBroker(const LocalBrokerSettings& s) : host_(s.host) {
    const std::string program = installed_broker();
    const auto file = s.folder / "broker.conf";
    for (int attempt = 0; attempt < attempts; ++attempt) {
        port_ = free_port();
        page_port_ = s.port == 0 ? free_port() : s.port;
        write_whole(file, fmt::format("per_listener_settings false\nallow_anonymous true\n"
                                      "persistence false\nlog_type error\nlog_type warning\n"
                                      "max_packet_size 8388608\nmax_queued_messages 1000\n{}"
                                      "listener {} 127.0.0.1\nlistener {} {}\n"
                                      "protocol websockets\nhttp_dir {}\n",
                                      geteuid() == 0 ? "user root\n" : "", port_, page_port_,
                                      s.host, std::filesystem::absolute(s.page).string()));
        program_ =
            std::make_unique<ChildProgram>(std::vector<std::string>{program, "-c", file.string()});
        const Instant began = this_instant();
        while (program_->runs() && !answers(port_) && seconds_since(began) < answer_time &&
               !interrupted())
            std::this_thread::sleep_for(glance);
        if (program_->runs() && answers(port_)) return;
        if (interrupted()) throw Interrupted("interrupted before the broker listened");
    }
    throw OutputError(
        fmt::format("broker: mosquitto does not listen on port {} of {}", page_port_, s.host));
}

std::string LocalBroker::address() const { return fmt::format("127.0.0.1:{}", port_); }
std::string LocalBroker::page() const {
    return fmt::format("http://{}:{}/index.html", host_, page_port_);
}

} // namespace bris
