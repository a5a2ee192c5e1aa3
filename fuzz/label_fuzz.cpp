#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <busbar/backend/label_name.hpp>

namespace label_fuzz {

using namespace busbar;

/// What is read is written as a text that is read as the same, and within the limits.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    static_cast<void>(backend::check_label_characters(text));
    const auto name = backend::parse_label_name(text);
    if (!name) {
        if (name.error().where.empty() || name.error().text.empty()) {
            std::abort();
        }
        return 0;
    }
    for (const auto& part : name->parts) {
        if (part.name.empty() || part.indices.size() > 3) {
            std::abort();
        }
    }
    const std::string written = backend::to_text(*name);
    const auto again = backend::parse_label_name(written);
    // A character has at most four bytes.
    if (written.size() > 4 * backend::max_label_name_length || !again || *again != *name ||
        backend::to_text(*again) != written || backend::key_of(*again) != backend::key_of(*name)) {
        std::abort();
    }
    return 0;
}

} // namespace label_fuzz
