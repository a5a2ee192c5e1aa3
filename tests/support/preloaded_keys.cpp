// A library for LD_PRELOAD. The programs that tests run do not make RSA keys: libcrypto gives them
// kept ones in turn, as support/kept_keys.hpp does in a test itself. BUSBAR_KEPT_KEYS is the folder
// of the keys, BUSBAR_KEYS_GIVEN a file that has a byte for each key that was given: the programs
// of one test share it, so that sixteen keys made after each other are sixteen. Without these two,
// and where BUSBAR_TEST_EFFORT is "full", keys are made. It needs neither libcrypto nor libstdc++:
// it is loaded into the shell, too.
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <openssl/evp.h>

namespace {

constexpr long kept_keys = 16;

template <typename Function>
Function libcrypto(const char* name)
{
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// The number of the next key, from 1; 0 if none can be told.
long next_number(const char* given)
{
    const int file = open(given, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (file < 0) {
        return 0;
    }
    struct stat status {};
    const bool is_counted =
        flock(file, LOCK_EX) == 0 && fstat(file, &status) == 0 && write(file, ".", 1) == 1;
    close(file);
    return is_counted ? status.st_size % kept_keys + 1 : 0;
}

EVP_PKEY* read_key(const char* path)
{
    using Read = EVP_PKEY* (*)(FILE*, EVP_PKEY**, pem_password_cb*, void*);
    const auto read = libcrypto<Read>("PEM_read_PrivateKey");
    FILE* const file = read != nullptr ? std::fopen(path, "rbe") : nullptr;
    if (file == nullptr) {
        return nullptr;
    }
    EVP_PKEY* const key = read(file, nullptr, nullptr, nullptr);
    std::fclose(file);
    return key;
}

/// Other programs see all of the file or nothing.
void keep(EVP_PKEY* key, const char* folder, const char* path)
{
    using Write = int (*)(FILE*, const EVP_PKEY*, const EVP_CIPHER*, const unsigned char*, int,
                          pem_password_cb*, void*);
    const auto write_key = libcrypto<Write>("PEM_write_PrivateKey");
    char part[4096 + 16];
    std::snprintf(part, sizeof part, "%s.%ld", path, static_cast<long>(getpid()));
    mkdir(folder, 0700);
    const int file = open(part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    FILE* const stream = file >= 0 ? fdopen(file, "w") : nullptr;
    if (stream == nullptr || write_key == nullptr) {
        return;
    }
    const bool is_written = write_key(stream, key, nullptr, nullptr, 0, nullptr, nullptr) == 1;
    if (std::fclose(stream) == 0 && is_written) {
        std::rename(part, path);
    } else {
        unlink(part);
    }
}

} // namespace

extern "C" __attribute__((visibility("default"))) EVP_PKEY*
EVP_PKEY_Q_keygen(OSSL_LIB_CTX* context, const char* properties, const char* type, ...)
{
    using Make = EVP_PKEY* (*)(OSSL_LIB_CTX*, const char*, const char*, ...);
    const auto make = libcrypto<Make>("EVP_PKEY_Q_keygen");
    if (make == nullptr) {
        return nullptr;
    }
    // What follows depends on the type: the size of a key or the name of a curve.
    va_list rest;
    va_start(rest, type);
    const bool is_rsa = std::strcmp(type, "RSA") == 0;
    const std::size_t bits = is_rsa ? va_arg(rest, std::size_t) : 0;
    const char* const curve = std::strcmp(type, "EC") == 0 ? va_arg(rest, const char*) : nullptr;
    va_end(rest);
    if (!is_rsa) {
        return curve != nullptr ? make(context, properties, type, curve)
                                : make(context, properties, type);
    }
    const char* const folder = std::getenv("BUSBAR_KEPT_KEYS");
    const char* const given = std::getenv("BUSBAR_KEYS_GIVEN");
    const char* const effort = std::getenv("BUSBAR_TEST_EFFORT");
    const bool is_full = effort != nullptr && std::strcmp(effort, "full") == 0;
    // Larger ones are seldom made.
    const bool is_kept = bits == 2048 && folder != nullptr && given != nullptr && !is_full;
    const long number = is_kept ? next_number(given) : 0;
    char path[4096];
    if (number == 0 || std::snprintf(path, sizeof path, "%s/made-2048-%ld.pem", folder, number) >=
                           static_cast<int>(sizeof path)) {
        return make(context, properties, type, bits);
    }
    EVP_PKEY* key = read_key(path);
    if (key == nullptr) {
        key = make(context, properties, type, bits);
        if (key != nullptr) {
            keep(key, folder, path);
        }
    }
    return key;
}
