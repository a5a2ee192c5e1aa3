#include <cstdint>
#include <cstdlib>

#include <busbar/crypto/pkcs12.hpp>

namespace pkcs12_fuzz {

using namespace busbar;

/// The input is a PKCS#12 file. Whatever is read from it fits together.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const auto contents = std::as_bytes(std::span{data, size});
    for (const char* passphrase : {"busbar", ""}) {
        const auto own = crypto::read_pkcs12(contents, passphrase, {.max_iterations = 10'000});
        if (own && (own->certificates.empty() || !own->key.belongs_to(own->certificates.front()))) {
            std::abort();
        }
    }
    return 0;
}

} // namespace pkcs12_fuzz
