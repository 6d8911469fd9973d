#include "engine/errors.hpp"
#include "engine/io/broker_client.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <arpa/inet.h>
#include <cmath>

namespace bris {

namespace {

/// Whether what is sent to a host does not leave this computer.
bool is_this_computer(const std::string& host) {
    in_addr four{};
    in6_addr six{};
    if (inet_pton(AF_INET, host.c_str(), &four) == 1) return ntohl(four.s_addr) >> 24 == 127;
    if (inet_pton(AF_INET6, host.c_str(), &six) == 1) return IN6_IS_ADDR_LOOPBACK(&six);
    return host == "localhost";
}

} // namespace

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

void BrokerSettings::check() const {
    const std::string host = host_and_port(address).first;
    require(password_file.empty() || !user.empty(),
            "--broker-password-file: expected --broker-user too, found none");
    require(password_file.empty() || !ca_file.empty() || plain || is_this_computer(host),
            fmt::format("--broker-password-file: expected a connection with TLS to {} "
                        "(--broker-ca-file), found none: everybody on the way could read the "
                        "password; --broker-plain sends it nevertheless",
                        host));
}

std::string BrokerSettings::password() const {
    if (password_file.empty()) return {};
    std::string text = read_whole(password_file);
    text.resize(std::min(text.size(), text.find_first_of("\r\n")));
    require(!text.empty(),
            fmt::format("{}:1: expected a password, found an empty line", password_file.string()));
    return text;
}

} // namespace bris
