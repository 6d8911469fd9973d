#include "tests/scenarios/monitoring/test_broker.hpp"

#include "engine/io/whole_file.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <arpa/inet.h>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <netinet/in.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <tuple>
#include <unistd.h>
#include <utility>

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

void TestBroker::make_certificates(const std::filesystem::path& folder, const std::string& host,
                                   int days) {
    // a script, since openssl needs files of its own for a certificate of the past
    write_whole(folder / "make.sh", fmt::format(R"(set -e
cd '{0}'
rm -f index.txt* serial*
for name in right wrong; do
  openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout $name.key \
    -out $name.pem -days 30 -subj "/CN=$name authority"
done
openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout server.key \
  -out server.csr -subj "/CN={1}"
printf '[ca]\ndefault_ca = d\n[d]\ndatabase = index.txt\nnew_certs_dir = .\nserial = serial\n' > ca.conf
printf 'policy = p\ndefault_md = sha256\n[p]\ncommonName = supplied\n' >> ca.conf
touch index.txt
echo 01 > serial
openssl ca -batch -config ca.conf -keyfile right.key -cert right.pem -in server.csr \
  -out server.pem -notext -startdate $(date -u -d '-9 days' +%y%m%d%H%M%SZ) \
  -enddate $(date -u -d '{2} days' +%y%m%d%H%M%SZ)
)",
                                                folder.string(), host, days));
    REQUIRE(run({"sh", "-c",
                 fmt::format("sh '{0}/make.sh' > '{0}/make.log' 2>&1", folder.string())}) == 0);
}

TestBroker::TestBroker(Kind kind) {
    const auto [s, port] = bound_socket();
    port_ = port;
    if (kind == Kind::silent || kind == Kind::absent) {
        listener_ = s;
        REQUIRE(listen(s, kind == Kind::silent ? 4 : 0) == 0);
        // the queue of the listener is full: the system leaves further attempts without an answer
        for (int k = 0; kind == Kind::absent && k < 3; ++k) {
            waiting_.push_back(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
            const sockaddr_in address = loopback(port_);
            (void)connect(waiting_.back(), reinterpret_cast<const sockaddr*>(&address),
                          sizeof address);
        }
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
    const std::string tls =
        fmt::format("certfile {0}/server.pem\nkeyfile {0}/server.key\n", folder_.path().string());
    if (kind == Kind::with_tls) make_certificates(folder_.path(), "127.0.0.1", 9);
    write_whole(folder_ / "broker.conf",
                fmt::format("listener {} 127.0.0.1\nallow_anonymous false\npassword_file {}\n"
                            "acl_file {}\npersistence false\nmax_queued_messages 10000\n"
                            "log_dest none\n{}{}",
                            port_, passwords, (folder_ / "acl").string(),
                            geteuid() == 0 ? "user root\n" : "",
                            kind == Kind::with_tls ? tls : ""));
    start();
}

TestBroker::~TestBroker() {
    stop();
    if (listener_ >= 0) close(listener_);
    for (const int s : waiting_) close(s);
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

TestLink::TestLink(int to) : to_(to) {
    std::tie(listener_, port_) = bound_socket();
    REQUIRE(listen(listener_, 4) == 0);
    thread_ = std::thread([this] { run(); });
}

TestLink::~TestLink() {
    ends_ = true;
    thread_.join();
    close(listener_);
}

std::string TestLink::address() const { return fmt::format("127.0.0.1:{}", port_); }

void TestLink::run() {
    std::vector<std::pair<int, int>> pairs; // sockets, each of whose bytes go to the other
    const auto end_all = [&] {
        for (const auto& [a, b] : pairs) {
            close(a);
            close(b);
        }
        pairs.clear();
    };
    const auto forward = [](int from, int to) { // false at the end
        std::array<char, 1 << 14> bytes;
        const ssize_t size = read(from, bytes.data(), bytes.size());
        return size > 0 && write(to, bytes.data(), static_cast<std::size_t>(size)) == size;
    };
    while (!ends_) {
        std::vector<pollfd> waits{{listener_, POLLIN, 0}};
        for (const auto& [a, b] : pairs) {
            waits.push_back({a, POLLIN, 0});
            waits.push_back({b, POLLIN, 0});
        }
        (void)poll(waits.data(), waits.size(), 10);
        if (is_cut_) end_all();
        if ((waits[0].revents & POLLIN) != 0) {
            const int near = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
            const int far = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
            const sockaddr_in address = loopback(to_);
            const bool connected =
                !is_cut_ &&
                connect(far, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
            if (connected) {
                pairs.emplace_back(near, far);
            } else {
                close(near);
                close(far);
            }
            continue;
        }
        if (is_cut_) continue;
        std::erase_if(pairs, [&, k = std::size_t{0}](const auto& pair) mutable {
            const bool from_a = waits[++k].revents != 0, from_b = waits[++k].revents != 0;
            const bool goes_on = (!from_a || forward(pair.first, pair.second)) &&
                                 (!from_b || forward(pair.second, pair.first));
            if (goes_on) return false;
            close(pair.first);
            close(pair.second);
            return true;
        });
    }
    end_all();
}

} // namespace bris::testing
