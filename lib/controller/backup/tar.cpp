#include "tar.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

namespace {

constexpr std::size_t block_size = 512;
constexpr std::size_t max_extended_header = 4'096;

/// A field of a header (POSIX.1-2017, pax, "ustar Interchange Format").
struct Field {
    std::size_t offset;
    std::size_t size;
};
constexpr Field name_field{0, 100};
constexpr Field mode_field{100, 8};
constexpr Field owner_field{108, 8};
constexpr Field group_field{116, 8};
constexpr Field size_field{124, 12};
constexpr Field time_field{136, 12};
constexpr Field checksum_field{148, 8};
constexpr Field type_field{156, 1};
constexpr Field link_field{157, 100};
constexpr Field magic_field{257, 8};
constexpr Field device_major_field{329, 8};
constexpr Field device_minor_field{337, 8};
constexpr Field prefix_field{345, 155};
constexpr Field unused_field{500, 12};

/// Magic and version.
constexpr std::string_view magic{"ustar\0"
                                 "00",
                                 8};
constexpr char regular_file = '0';
constexpr char extended_header = 'x';
/// The largest number in the octal digits of a field of 12 bytes.
constexpr std::int64_t max_number = (std::int64_t{1} << 33U) - 1;

constexpr std::size_t padded(std::size_t size)
{
    return (size + block_size - 1) / block_size * block_size;
}

std::string_view text_in(std::span<const std::byte> header, Field field)
{
    return as_text(header.subspan(field.offset, field.size));
}

bool is_zero(std::span<const std::byte> bytes)
{
    return std::ranges::all_of(bytes, [](std::byte each) { return each == std::byte{0}; });
}

/// The sum of all bytes, with blanks in place of the sum.
std::uint32_t sum_of(std::span<const std::byte> header)
{
    std::uint32_t sum = checksum_field.size * std::uint32_t{' '};
    for (std::size_t i = 0; i < header.size(); ++i) {
        const bool is_sum =
            i >= checksum_field.offset && i < checksum_field.offset + checksum_field.size;
        sum += is_sum ? 0U : std::to_integer<std::uint32_t>(header[i]);
    }
    return sum;
}

// Writing.

bool fits_header(std::string_view name)
{
    return name.size() <= name_field.size && std::ranges::all_of(name, [](char each) {
               return static_cast<unsigned char>(each) < 0x80;
           });
}

/// "18 path=files/é\n": the number counts itself, too.
std::string path_record(std::string_view name)
{
    constexpr std::string_view keyword = " path=";
    const std::size_t rest = keyword.size() + name.size() + 1;
    std::size_t size = rest;
    while (size != rest + std::to_string(size).size()) {
        size = rest + std::to_string(size).size();
    }
    return std::to_string(size).append(keyword).append(name) + '\n';
}

class HeaderWriter {
public:
    void put_text(Field field, std::string_view text)
    {
        const auto bytes = as_data(text.substr(0, field.size));
        std::ranges::copy(bytes, bytes_.begin() + static_cast<std::ptrdiff_t>(field.offset));
    }
    /// Octal digits that leave one byte free.
    void put_number(Field field, std::uint64_t number)
    {
        for (std::size_t i = field.size - 1; i-- > 0; number >>= 3U) {
            bytes_[field.offset + i] = static_cast<std::byte>('0' + (number & 7U));
        }
    }
    [[nodiscard]] std::span<const std::byte> seal()
    {
        // Other than numbers, the sum has 6 digits, NUL and a blank.
        put_number({checksum_field.offset, checksum_field.size - 1}, sum_of(bytes_));
        bytes_[checksum_field.offset + checksum_field.size - 1] = std::byte{' '};
        return bytes_;
    }

private:
    std::array<std::byte, block_size> bytes_{};
};

// Reading.

std::optional<std::size_t> octal(std::string_view digits)
{
    std::size_t number = 0;
    const char* const end = digits.data() + digits.size();
    const auto read = std::from_chars(digits.data(), end, number, 8);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{number} : std::nullopt;
}

std::optional<std::size_t> size_in(std::span<const std::byte> header)
{
    const std::string_view field = text_in(header, size_field);
    const bool is_ended = field.back() == '\0' || field.back() == ' ';
    return is_ended ? octal(field.substr(0, field.size() - 1)) : std::nullopt;
}

bool has_right_sum(std::span<const std::byte> header)
{
    const std::string_view field = text_in(header, checksum_field);
    return field.substr(6) == std::string_view{"\0 ", 2} &&
           octal(field.substr(0, 6)) == sum_of(header);
}

/// Returns the text of a field; nothing if other bytes than zeros follow its end.
std::optional<std::string_view> ended_text(std::string_view field)
{
    const std::size_t end = std::min(field.find('\0'), field.size());
    return is_zero(as_data(field.substr(end))) ? std::optional{field.substr(0, end)} : std::nullopt;
}

std::optional<std::string> name_in(std::span<const std::byte> header)
{
    const auto name = ended_text(text_in(header, name_field));
    const auto prefix = ended_text(text_in(header, prefix_field));
    if (!name || !prefix || name->empty()) {
        return std::nullopt;
    }
    return prefix->empty() ? std::string{*name} : std::string{*prefix}.append("/").append(*name);
}

/// Returns the path of an extended header; nothing if it has other records as well.
std::optional<std::string> path_in(std::string_view records)
{
    const std::size_t begin = std::min(records.find('='), records.size());
    const std::string_view name =
        begin + 2 < records.size() ? records.substr(begin + 1, records.size() - begin - 2) : "";
    const bool is_path =
        !name.empty() && name.find('\0') == std::string_view::npos && path_record(name) == records;
    return is_path ? std::optional<std::string>{name} : std::nullopt;
}

std::string kind_of(char type)
{
    switch (type) {
    case '1':
    case '2':
        return "a link";
    case '3':
    case '4':
        return "a device";
    case '5':
        return "a folder";
    case '6':
        return "a pipe";
    default:
        return "an entry of type " + printable({&type, 1});
    }
}

} // namespace

TarWriter::TarWriter(std::int64_t modified)
    : modified_{std::clamp(modified, std::int64_t{0}, max_number)}
{
}

std::size_t TarWriter::size_of(std::string_view name, std::size_t size)
{
    const std::size_t file = block_size + padded(size);
    return fits_header(name) ? file : file + block_size + padded(path_record(name).size());
}

void TarWriter::add(std::string_view name, std::span<const std::byte> bytes)
{
    if (fits_header(name)) {
        append_header(name, bytes.size(), regular_file);
        append(bytes);
        return;
    }
    // Tools that do not know extended headers see these names, which differ.
    const std::string place = std::to_string(file_.size() / block_size);
    const std::string record = path_record(name);
    append_header("PaxHeaders/" + place, record.size(), extended_header);
    append(as_data(record));
    append_header("long-name-" + place, bytes.size(), regular_file);
    append(bytes);
}

std::vector<std::byte> TarWriter::take()
{
    file_.resize(file_.size() + end_size);
    return std::move(file_);
}

void TarWriter::append_header(std::string_view name, std::size_t size, char type)
{
    HeaderWriter header;
    header.put_text(name_field, name);
    header.put_number(mode_field, 0600);
    header.put_number(owner_field, 0);
    header.put_number(group_field, 0);
    header.put_number(size_field, size);
    header.put_number(time_field, static_cast<std::uint64_t>(modified_));
    header.put_text(type_field, {&type, 1});
    header.put_text(magic_field, magic);
    header.put_number(device_major_field, 0);
    header.put_number(device_minor_field, 0);
    append(header.seal());
}

void TarWriter::append(std::span<const std::byte> bytes)
{
    file_.insert(file_.end(), bytes.begin(), bytes.end());
    file_.resize(padded(file_.size()));
}

bool TarReader::is_tar(std::span<const std::byte> bytes)
{
    return bytes.size() >= block_size && text_in(bytes, magic_field) == magic;
}

Configured<std::optional<TarFile>> TarReader::next()
{
    auto entry = next_entry();
    std::optional<std::string> path;
    if (entry && *entry && (*entry)->type == extended_header) {
        path = (*entry)->bytes.size() <= max_extended_header ? path_in(as_text((*entry)->bytes))
                                                             : std::nullopt;
        if (!path) {
            return refuse("an extended header that is not a single path");
        }
        entry = next_entry();
        if (entry && (!*entry || (*entry)->type == extended_header)) {
            return refuse("an extended header that no file follows");
        }
    }
    if (!entry) {
        return Unexpected{std::move(entry.error())};
    }
    if (!*entry) {
        return std::optional<TarFile>{};
    }
    return TarFile{path ? *std::move(path) : std::move((*entry)->name), (*entry)->bytes};
}

/// Returns the next header, and the bytes after it.
Configured<std::optional<TarReader::Entry>> TarReader::next_entry()
{
    const auto header = take_bytes(block_size);
    if (!header) {
        return Unexpected{header.error()};
    }
    if (is_zero(*header)) {
        return check_end().transform([] { return std::optional<Entry>{}; });
    }
    if (!is_tar(*header) || !has_right_sum(*header)) {
        return refuse("a header that is damaged or of another kind than ustar and pax");
    }
    const char type = text_in(*header, type_field).front();
    if (type != regular_file && type != extended_header) {
        return refuse(kind_of(type));
    }
    auto name = name_in(*header);
    const auto size = size_in(*header);
    if (!name || !size || !is_zero(header->subspan(link_field.offset, link_field.size)) ||
        !is_zero(header->subspan(unused_field.offset, unused_field.size))) {
        return refuse("a file with a wrong name or size, or with the target of a link");
    }
    const auto bytes = take_bytes(*size);
    if (!bytes) {
        return Unexpected{bytes.error()};
    }
    return Entry{type, *std::move(name), *bytes};
}

/// Takes the zeros after them, too.
Configured<std::span<const std::byte>> TarReader::take_bytes(std::size_t size)
{
    const std::size_t left = tar_.size() - at_;
    if (size > left || padded(size) > left) {
        return refuse("its end within a file");
    }
    const auto bytes = tar_.subspan(at_, padded(size));
    if (!is_zero(bytes.subspan(size))) {
        return refuse("bytes after the end of a file");
    }
    at_ += bytes.size();
    return bytes.first(size);
}

/// A block of zeros was taken. Another one follows, and what fills the last record of a tape.
Configured<void> TarReader::check_end() const
{
    const auto rest = tar_.subspan(at_);
    if (rest.size() < block_size || rest.size() % block_size != 0 || !is_zero(rest)) {
        return refuse("no two blocks of zeros at its end, or something after them");
    }
    return {};
}

Unexpected<Problem> TarReader::refuse(const std::string& found) const
{
    return misconfigured("backup", "is cut, damaged or not of this kind of tar: found " + found +
                                       " before byte " + std::to_string(at_));
}

} // namespace busbar::controller::detail
