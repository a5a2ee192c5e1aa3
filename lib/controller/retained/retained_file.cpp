#include "retained_file.hpp"

#include <algorithm>

#include "controller/life/checksum.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::uint32_t magic = 0x5652'4242; // "BBRV"
constexpr std::uint32_t version = 2;
/// The version without the number of a write.
constexpr std::uint32_t first_version = 1;
constexpr std::size_t crc_size = 4;

std::span<const std::byte> without_crc(std::span<const std::byte> file)
{
    return file.first(file.size() < crc_size ? 0 : file.size() - crc_size);
}

} // namespace

RetainedWriter::RetainedWriter(std::size_t count, std::uint64_t last_write) : writer_{sink_}
{
    writer_.number(magic);
    writer_.number(version);
    writer_.number(last_write);
    writer_.number(static_cast<std::uint32_t>(count));
}

void RetainedWriter::add(const RetainedValue& value)
{
    writer_.number(static_cast<std::uint32_t>(value.name.size()));
    writer_.bytes(std::as_bytes(std::span{value.name.data(), value.name.size()}));
    writer_.number(value.type_print);
    writer_.number(static_cast<std::uint32_t>(value.bytes.size()));
    writer_.bytes(value.bytes);
}

std::vector<std::byte> RetainedWriter::take()
{
    std::vector<std::byte> file = sink_.take(writer_.written());
    const std::uint32_t crc = checksum(file);
    for (unsigned shift = 0; shift < 32; shift += 8) {
        file.push_back(static_cast<std::byte>(crc >> shift));
    }
    return file;
}

RetainedReader::RetainedReader(std::span<const std::byte> file) : reader_{without_crc(file)}
{
    const auto found_magic = reader_.number<std::uint32_t>();
    const auto found_version = reader_.number<std::uint32_t>();
    if (found_version != first_version) {
        last_write_ = reader_.number<std::uint64_t>();
    }
    left_ = reader_.number<std::uint32_t>();
    binary::Reader end{file.last(std::min(file.size(), crc_size))};
    if (!reader_.ok() || found_magic != magic) {
        problem_ = "is not a file of retained values";
    } else if (end.number<std::uint32_t>() != checksum(without_crc(file))) {
        problem_ = "is damaged: its checksum does not match";
    } else if (found_version != version && found_version != first_version) {
        problem_ = "has version " + std::to_string(found_version) + "; expected " +
                   std::to_string(version);
    }
    if (!problem_.empty()) {
        left_ = 0;
        last_write_ = 0;
    }
}

std::optional<RetainedValue> RetainedReader::next()
{
    if (left_ == 0) {
        return std::nullopt;
    }
    --left_;
    const auto name = reader_.bytes(reader_.number<std::uint32_t>());
    const auto type_print = reader_.number<std::uint64_t>();
    const auto bytes = reader_.bytes(reader_.number<std::uint32_t>());
    if (!reader_.ok()) {
        left_ = 0;
        return std::nullopt;
    }
    return RetainedValue{
        {reinterpret_cast<const char*>(name.data()), name.size()}, type_print, bytes};
}

} // namespace busbar::controller::detail
