#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <unistd.h>

#include <busbar/crypto/private_key.hpp>

namespace busbar::test {

/// True while this thread makes a key to keep, which support/kept_keys.cpp then really makes.
inline thread_local bool makes_kept_key{false};

/// Reads a key that an earlier test program has kept; none if there is none of this size.
[[nodiscard]] inline Result<crypto::PrivateKey> read_key(const std::filesystem::path& path,
                                                         std::uint32_t bits)
{
    std::ifstream file{path, std::ios::binary};
    const std::vector<char> text{std::istreambuf_iterator<char>{file}, {}};
    auto key = crypto::PrivateKey::parse(std::as_bytes(std::span{text}));
    return key && key->key_size() * 8 == bits ? key : fail(status::Bad_NotFound);
}

/// A private key for tests. RSA keys take long to make, so those of a name are kept in the build
/// tree, in a folder that only its owner may read, and are the same in the next program. Asked
/// again for the same name, a program gets another key each time.
[[nodiscard]] inline crypto::PrivateKey kept_key(const std::string& name, std::uint32_t bits)
{
    namespace fs = std::filesystem;
    static std::mutex mutex;
    static std::map<std::string, int> uses;
    const std::lock_guard lock{mutex};
    const std::string file = name + "-" + std::to_string(bits);
    const fs::path folder{BUSBAR_BINARY_DIR "/test-keys"};
    const fs::path path = folder / (file + "-" + std::to_string(++uses[file]) + ".pem");
    if (auto kept = read_key(path, bits)) {
        return *std::move(kept);
    }
    makes_kept_key = true;
    auto key = *crypto::PrivateKey::generate(bits);
    makes_kept_key = false;
    std::error_code error;
    fs::create_directories(folder, error);
    fs::permissions(folder, fs::perms::owner_all, error);
    // Other programs see all of it or nothing; if it cannot be kept, it is made again.
    const fs::path part = path.string() + "." + std::to_string(::getpid());
    const auto text = key.to_pem();
    if (!error && text) {
        std::ofstream{part, std::ios::binary}.write(
            reinterpret_cast<const char*>(text->span().data()),
            static_cast<std::streamsize>(text->span().size()));
        fs::permissions(part, fs::perms::owner_read | fs::perms::owner_write, error);
        fs::rename(part, path, error);
    }
    return key;
}

} // namespace busbar::test
