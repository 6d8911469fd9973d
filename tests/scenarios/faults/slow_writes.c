/* Preloaded by kill_campaign: every write of a file takes BRIS_WRITE_MICROSECONDS longer, fsync and rename ten times that, and the
   monotonic clock is BRIS_CLOCK times as fast, so that a run writes checkpoints often and spends much of its time in writing them. The
   first fsync takes BRIS_FIRST_SYNC_SECONDS longer, the first write of a megabyte or more BRIS_FIRST_LARGE_WRITE_SECONDS. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static long number_of(const char* name, long otherwise) {
    const char* text = getenv(name);
    return text != NULL ? atol(text) : otherwise;
}

static void delay(long times) {
    const long microseconds = times * number_of("BRIS_WRITE_MICROSECONDS", 0);
    const struct timespec time = {microseconds / 1000000, microseconds % 1000000 * 1000};
    nanosleep(&time, NULL);
}

ssize_t write(int file, const void* data, size_t size) {
    if (file > STDERR_FILENO) delay(1);
    return syscall(SYS_write, file, data, size);
}

static void delay_large(size_t size) {
    static int waited = 0;
    const struct timespec first = {number_of("BRIS_FIRST_LARGE_WRITE_SECONDS", 0), 0};
    if (size < 1000000 || waited) return;
    waited = 1;
    nanosleep(&first, NULL);
}

ssize_t pwrite(int file, const void* data, size_t size, off_t at) {
    delay(1);
    delay_large(size);
    return syscall(SYS_pwrite64, file, data, size, at);
}

ssize_t pwrite64(int file, const void* data, size_t size, off64_t at) {
    delay(1);
    delay_large(size);
    return syscall(SYS_pwrite64, file, data, size, at);
}

int fsync(int file) {
    static int waited = 0;
    const struct timespec first = {number_of("BRIS_FIRST_SYNC_SECONDS", 0), 0};
    if (!waited) nanosleep(&first, NULL);
    waited = 1;
    delay(10);
    return (int)syscall(SYS_fsync, file);
}

int rename(const char* from, const char* to) {
    delay(10);
    const int result = (int)syscall(SYS_rename, from, to);
    delay(10);
    return result;
}

int clock_gettime(clockid_t clock, struct timespec* now) {
    static long long began = 0;
    const int result = (int)syscall(SYS_clock_gettime, clock, now);
    if (clock != CLOCK_MONOTONIC || result != 0) return result;
    const long long time = now->tv_sec * 1000000000ll + now->tv_nsec;
    if (began == 0) began = time;
    const long long shown = began + (time - began) * number_of("BRIS_CLOCK", 1);
    now->tv_sec = shown / 1000000000ll;
    now->tv_nsec = shown % 1000000000ll;
    return 0;
}
