#include "scenarios/stream/run_broker.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/message.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

constexpr double farewell = 2; // s for the last publications

void keep_aside(const std::filesystem::path& log) {
    auto kept = log.string() + ".before";
    for (int k = 2; std::filesystem::exists(kept); ++k)
        kept = fmt::format("{}.before.{}", log.string(), k);
    std::filesystem::rename(log, kept);
}

bool is_resumed(const Common& common) {
    return !common.resume.empty() && std::filesystem::is_directory(common.resume);
}

} // namespace

void go_on_with_arrivals(const Common& common) {
    const auto before = common.resume / log_name;
    if (is_resumed(common) && std::filesystem::exists(before)) go_on_after(arrivals_in(before));
}

std::shared_ptr<StreamLog> begin_log(const RunBrokerSettings& s, LoggedRecords records,
                                     const std::filesystem::path& stream, const Common& common) {
    const auto log = common.out / log_name;
    std::error_code error;
    require(!std::filesystem::equivalent(stream, log, error),
            fmt::format("--stream, --out: expected two files, found '{}' as the stream and as the "
                        "log of it",
                        log.string()));
    const bool goes_on = is_resumed(common);
    if (!goes_on && std::filesystem::exists(log)) keep_aside(log);
    if (s.history <= 0) return {};
    const auto before = common.resume / log_name;
    if (goes_on && std::filesystem::exists(before) &&
        !std::filesystem::equivalent(common.resume, common.out, error)) {
        require_regular_file(before);
        std::filesystem::copy_file(before, log, std::filesystem::copy_options::overwrite_existing);
    }
    return std::make_shared<StreamLog>(
        log, records, static_cast<std::uint64_t>(s.history * static_cast<double>(1 << 30)));
}

std::string report_on_log(const StreamLog* log, const RunBrokerSettings& s) {
    if (log == nullptr || log->left_out() == 0) return {};
    return fmt::format("log: {} entries left out beyond {:g} GiB (--broker-history)\n",
                       log->left_out(), s.history);
}

RunBroker::RunBroker(const RunBrokerSettings& s, const std::filesystem::path& stream, double speed,
                     const Common& common)
    : name_(s.client.session.empty() ? common.scenario : s.client.session),
      gives_records_(stream.empty() || records_of_log(stream) == LoggedRecords::messages) {
    if (!s.client.address.empty()) {
        BrokerSettings client = s.client;
        client.run = name_;
        client_.emplace(client, common.scenario,
                        stream.empty() ? BrokerLines::topics() : std::vector<std::string>{},
                        stream.empty() ? BrokerClient::Start::answered : BrokerClient::Start::any);
        if (const std::string problem = client_->problem(); !problem.empty())
            say(fmt::format("{}: {}; the run goes on and tries again", common.scenario, problem));
    }
    if (!stream.empty() && gives_records_)
        replayed_.emplace(stream, speed, client_ ? &*client_ : nullptr);
}

void RunBroker::report_doing(const std::string& doing, double left) {
    if (client_ && client_->signs_of_life()) client_->signs_of_life()->report(doing, left);
}

void RunBroker::finish() {
    if (!client_) return;
    if (client_->signs_of_life()) client_->signs_of_life()->end();
    client_->flush(farewell);
    client_->end_session();
}

} // namespace bris
