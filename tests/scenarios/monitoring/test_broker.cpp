#include "tests/scenarios/monitoring/test_broker.hpp"

#include "engine/io/whole_file.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <arpa/inet.h>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace bris::testing {

namespace {

const char* installed_broker() {
    for (const char* path : {"/usr/sbin/mosquitto", "/usr/local/sbin/mosquitto"})
        if (access(path, X_OK) == 0) return path;
    return nullptr;
}

sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

/// A socket bound to a free port, and the port.
std::pair<int, int> bound_socket() {
    const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    REQUIRE(bind(s, reinterpret_cast<sockaddr*>(&address), size) == 0);
    REQUIRE(getsockname(s, reinterpret_cast<sockaddr*>(&address), &size) == 0);
    return {s, ntohs(address.sin_port)};
}

bool answers(int port) {
    const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = loopback(port);
    const bool connected = connect(s, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    close(s);
    return connected;
}

int run(std::vector<std::string> words) {
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    pid_t process = 0;
    int status = -1;
    if (posix_spawnp(&process, pointers[0], nullptr, nullptr, pointers.data(), environ) != 0 ||
        waitpid(process, &status, 0) != process)
        return -1;
    return status;
}

} // namespace

TestBroker::TestBroker(Kind kind) {
    const auto [s, port] = bound_socket();
    port_ = port;
    if (kind == Kind::silent) {
        listener_ = s;
        REQUIRE(listen(s, 4) == 0);
        return;
    }
    close(s);
    if (!has_broker_client() || installed_broker() == nullptr) {
        MESSAGE("skipped: needs the Debian packages mosquitto and libmosquitto-dev");
        return;
    }
    const auto passwords = (folder_ / "passwords").string();
    write_whole(passwords, "");
    for (const char* user : {"model", "rocks", "page"}) {
        write_whole(folder_ / user, fmt::format("secret of {}\n", user));
        REQUIRE(run({"mosquitto_passwd", "-b", passwords, user,
                     fmt::format("secret of {}", user)}) == 0);
    }
    write_whole(folder_ / "acl",
                "user model\ntopic read smartrock/#\ntopic read test_machine/#\n"
                "topic write bris/#\ntopic write smartrock/+/alarm\n"
                "topic write smartrock/+/pose\n\n"
                "user rocks\ntopic write smartrock/+/imu\n"
                "topic write smartrock/+/status\ntopic write smartrock/+/config/ack\n"
                "topic read smartrock/+/config\ntopic write test_machine/record\n\n"
                "user page\ntopic read bris/#\ntopic read smartrock/#\n"
                "topic write smartrock/+/config\n");
    write_whole(folder_ / "broker.conf",
                fmt::format("listener {} 127.0.0.1\nallow_anonymous false\npassword_file {}\n"
                            "acl_file {}\npersistence false\nlog_dest none\n{}",
                            port_, passwords, (folder_ / "acl").string(),
                            geteuid() == 0 ? "user root\n" : ""));
    start();
}

TestBroker::~TestBroker() {
    stop();
    if (listener_ >= 0) close(listener_);
}

void TestBroker::start() {
    std::string program = installed_broker(), flag = "-c",
                file = (folder_ / "broker.conf").string();
    char* words[] = {program.data(), flag.data(), file.data(), nullptr};
    REQUIRE(posix_spawn(&process_, words[0], nullptr, nullptr, words, environ) == 0);
    for (int k = 0; k < 200 && !answers(port_); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

void TestBroker::stop() {
    if (process_ <= 0) return;
    kill(process_, SIGTERM);
    (void)waitpid(process_, nullptr, 0);
    process_ = 0;
}

std::string TestBroker::address() const { return fmt::format("127.0.0.1:{}", port_); }

BrokerSettings TestBroker::settings(const std::string& user) const {
    BrokerSettings s;
    s.address = address();
    s.user = user;
    s.password_file = folder_ / user;
    return s;
}

} // namespace bris::testing
