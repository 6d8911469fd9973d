#pragma once

// What the members of Hdf5File need of the library, which no other file includes.

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <new>
#include <pthread.h>
#include <utility>
#include <vector>

namespace bris {

/// The library as built by Debian allows one thread at a time, even for different files, and prints
/// its errors unless told otherwise.
class Alone {
public:
    Alone() : lock_(mutex()) {
        // The library must not clean up when the process ends, because it crashes there after a
        // failed write (disk full); every file is closed by its owner. This holds only if it is the
        // first call into the library: any other call initialises it, and so registers the cleanup.
        static const herr_t without_cleanup = H5dont_atexit();
        static_cast<void>(without_cleanup);
        // a child process starts while no thread is in the library, and has a lock of its own
        static const int forks = pthread_atfork([] { mutex().lock(); }, [] { mutex().unlock(); },
                                                [] { new (&mutex()) std::recursive_mutex; });
        static_cast<void>(forks);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }

private:
    static std::recursive_mutex& mutex() {
        static std::recursive_mutex one;
        return one;
    }
    std::lock_guard<std::recursive_mutex> lock_;
};

/// A handle that is closed when it goes out of scope.
template <herr_t (*close)(hid_t)>
class Handle {
public:
    explicit Handle(hid_t id) : id_(id) {}
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (id_ >= 0) close(id_);
    }
    operator hid_t() const { return id_; }
    /// Closes now; false if that failed. A dataset's last values are written when it is closed.
    bool closed_well() { return close(std::exchange(id_, -1)) >= 0; }

private:
    hid_t id_;
};
using Object = Handle<H5Oclose>;
using Group = Handle<H5Gclose>;
using Dataset = Handle<H5Dclose>;
using Space = Handle<H5Sclose>;
using Type = Handle<H5Tclose>;
using Properties = Handle<H5Pclose>;
using Attribute = Handle<H5Aclose>;

inline std::vector<hsize_t> dimensions(const std::vector<std::uint64_t>& shape) {
    return {shape.begin(), shape.end()};
}

} // namespace bris
