#include "openssl.hpp"

#include <climits>

namespace busbar::crypto::detail {

Bio memory_bio(std::span<const std::byte> bytes)
{
    if (bytes.size() > static_cast<std::size_t>(INT_MAX)) {
        return nullptr;
    }
    return Bio{BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size()))};
}

} // namespace busbar::crypto::detail
