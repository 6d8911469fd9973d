#include "engine/io/line_source.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <iterator>
#include <mutex>
#include <poll.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace bris {

namespace {

// interval between checks of a growing file and of requests to stop
constexpr auto glance = std::chrono::milliseconds(20);

} // namespace

struct LineSource::Reader {
    int file = -1;
    bool is_file = false, grows = false,
         unwritten = false; // unwritten: a pipe without a writer so far
    std::size_t capacity;
    std::deque<Line> queue;
    bool ended = false;
    mutable std::mutex mutex;
    std::condition_variable came, room;
    std::atomic<bool> stop = false;
    std::thread thread;
    // used by the reading thread only
    Line line{1, {}, {}, true};
    std::vector<Line> whole; // lines of what was read last, which are queued together
    // used by the thread that takes the lines only
    std::deque<Line> taken;

    Reader(const std::filesystem::path& path, std::size_t most) : capacity(most) {
        // non-blocking, because a pipe may have no writer yet
        file = path == "-" ? STDIN_FILENO : open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
        struct stat about {};
        const bool is_known = file >= 0 && fstat(file, &about) == 0;
        if (!is_known || S_ISDIR(about.st_mode)) {
            const std::string why =
                is_known ? "expected a file or pipe, found a folder" : std::strerror(errno);
            if (file > STDIN_FILENO) close(file);
            throw OutputError(fmt::format("cannot read '{}': {}", path.string(), why));
        }
        is_file = S_ISREG(about.st_mode);
        grows = is_file && path != "-";
        unwritten = S_ISFIFO(about.st_mode) && path != "-";
        thread = std::thread([this] { read_all(); });
    }
    ~Reader() {
        stop = true;
        room.notify_all();
        thread.join();
        if (file != STDIN_FILENO) close(file);
    }
    void read_all() {
        std::array<char, 1 << 14> bytes{};
        while (!stop) {
            pollfd ready{file, POLLIN, 0};
            if (poll(&ready, 1, static_cast<int>(glance.count())) <= 0) continue;
            const ssize_t count = read(file, bytes.data(), bytes.size());
            if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
            if (count > 0) {
                unwritten = false;
                take({bytes.data(), static_cast<std::size_t>(count)});
            } else if ((grows || unwritten) && count == 0) {
                std::this_thread::sleep_for(glance);
            } else {
                break;
            }
        }
        if (!line.text.empty()) {
            line.whole = false;
            end_line(this_instant(), is_file ? no_arrival : arrival_now());
            put();
        }
        const std::lock_guard lock(mutex);
        ended = true;
        came.notify_all();
    }
    void take(std::string_view text) {
        const Instant instant = this_instant();
        const double arrival = is_file ? no_arrival : arrival_now();
        while (!text.empty()) {
            const std::size_t end = text.find('\n');
            const std::string_view part = text.substr(0, end);
            line.whole = line.whole && part.size() <= longest - line.text.size();
            line.text += part.substr(0, longest - line.text.size());
            if (end == std::string_view::npos) break;
            end_line(instant, arrival);
            text.remove_prefix(end + 1);
        }
        put();
    }
    void end_line(Instant instant, double arrival) {
        line.arrived = instant;
        line.arrival = arrival;
        const std::uint64_t number = line.number;
        whole.push_back(std::move(line));
        line = {number + 1, {}, {}, true};
    }
    void put() {
        if (whole.empty()) return;
        std::unique_lock lock(mutex);
        while (queue.size() >= capacity && !stop) room.wait_for(lock, glance);
        const bool was_empty = queue.empty();
        std::ranges::move(whole, std::back_inserter(queue));
        whole.clear();
        if (was_empty) came.notify_all(); // who waits found it empty
    }
    /// Takes all lines of the queue at once, because a lock for each costs more than reading it.
    void take_lines(double timeout) {
        const Instant began = this_instant();
        std::unique_lock lock(mutex);
        while (queue.empty() && !ended && !interrupted() && seconds_since(began) < timeout)
            came.wait_for(lock, glance);
        taken.swap(queue);
        room.notify_one();
    }
};

LineSource::LineSource(const std::filesystem::path& path, std::size_t capacity)
    : reader_(std::make_unique<Reader>(path, capacity)) {}
LineSource::~LineSource() = default;

std::optional<LineSource::Line> LineSource::next(double timeout) {
    if (reader_->taken.empty()) reader_->take_lines(timeout);
    if (reader_->taken.empty()) return {};
    Line line = std::move(reader_->taken.front());
    reader_->taken.pop_front();
    return line;
}

double LineSource::now() const { return reader_->is_file ? no_arrival : arrival_now(); }

bool LineSource::over() const {
    if (!reader_->taken.empty()) return false;
    const std::lock_guard lock(reader_->mutex);
    return reader_->ended && reader_->queue.empty();
}

} // namespace bris
