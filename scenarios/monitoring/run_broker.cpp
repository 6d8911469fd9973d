#include "scenarios/monitoring/run_broker.hpp"

#include "engine/errors.hpp"
#include "engine/message.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace bris {

namespace {

constexpr double farewell = 2; // s for the last publications

std::filesystem::path folder_of_resumed(const Common& common) {
    return std::filesystem::is_directory(common.resume) ? common.resume
                                                        : common.resume.parent_path();
}

} // namespace

RunBroker::RunBroker(const RunBrokerSettings& s, const std::filesystem::path& stream, double speed,
                     const Common& common)
    : name_(s.client.session.empty() ? common.scenario : s.client.session), history_(s.history),
      gives_records_(stream.empty() || is_hdf5(stream)) {
    std::error_code error;
    require(!is_hdf5(stream) ||
                !std::filesystem::equivalent(std::filesystem::absolute(stream).parent_path(),
                                             common.out, error),
            fmt::format("--stream, --out: expected a history in another folder than that of the "
                        "results, which replace it, found '{}'",
                        stream.string()));
    if (!s.client.address.empty()) {
        BrokerSettings client = s.client;
        client.run = name_;
        client_.emplace(client, common.scenario,
                        stream.empty() ? BrokerLines::topics() : std::vector<std::string>{},
                        stream.empty() ? BrokerClient::Start::answered : BrokerClient::Start::any);
        if (const std::string problem = client_->problem(); !problem.empty())
            say(fmt::format("{}: {}; the run goes on and tries again", common.scenario, problem));
    }
    if (is_hdf5(stream)) replayed_.emplace(stream, speed, client_ ? &*client_ : nullptr);
}

void RunBroker::keep_in(Hdf5File& file, const std::filesystem::path& earlier) {
    if (history_ <= 0) return;
    kept_.emplace(file, static_cast<std::uint64_t>(history_ * static_cast<double>(1 << 30)));
    if (!earlier.empty()) {
        try {
            HistoryReader reader(earlier);
            while (auto message = reader.next()) kept_->add(std::move(*message));
        } catch (const std::exception& e) { // of a run that was killed while it wrote
            say(fmt::format("the history before the run was resumed is lost: {}", e.what()));
        }
    }
    recorded_.emplace(source(), *kept_);
}

void RunBroker::report_doing(const std::string& doing, double left) {
    if (client_ && client_->signs_of_life()) client_->signs_of_life()->report(doing, left);
}

void RunBroker::finish() {
    if (client_) {
        if (client_->signs_of_life()) client_->signs_of_life()->end();
        client_->flush(farewell);
        client_->end_session();
    }
    if (kept_) kept_->close();
}

std::string RunBroker::report() const {
    if (!kept_ || kept_->left_out() == 0) return {};
    return fmt::format("history: {} messages left out beyond {:g} GiB (--broker-history)\n",
                       kept_->left_out(), history_);
}

std::filesystem::path put_aside_run_file(const Common& common, const std::string& name) {
    if (common.resume.empty()) return {};
    const auto file = folder_of_resumed(common) / name;
    const auto aside = common.out / (name + ".earlier"); // there: a run was killed right after this
    if (!std::filesystem::exists(aside)) {
        if (!is_hdf5(file)) return {};
        std::error_code error;
        if (std::filesystem::equivalent(file.parent_path(), common.out, error))
            std::filesystem::rename(file, aside);
        else
            std::filesystem::copy_file(file, aside);
    }
    return aside;
}

} // namespace bris
