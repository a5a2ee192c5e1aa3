#include "backup_file.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/crypto/digest.hpp>

#include "controller/life/checksum.hpp"
#include "tar.hpp"

namespace busbar::controller::detail {

namespace {

using Bytes = std::span<const std::byte>;

constexpr std::string_view sums_name = "SHA256SUMS";
constexpr std::string_view manifest_name = "manifest.json";

std::string place_of(std::string_view name)
{
    return std::string{"files/"}.append(name);
}

/// A line as sha256sum writes it, in which names with these characters are marked.
std::string sum_line(std::string_view name, Bytes bytes)
{
    constexpr std::string_view digits = "0123456789abcdef";
    std::string line = name.find_first_of("\\\n\r") != std::string_view::npos ? "\\" : "";
    for (const std::byte byte : crypto::sha256(bytes)) {
        line += digits[std::to_integer<std::size_t>(byte >> 4U)];
        line += digits[std::to_integer<std::size_t>(byte & std::byte{15})];
    }
    line += "  ";
    for (const char each : name) {
        switch (each) {
        case '\\':
            line += R"(\\)";
            break;
        case '\n':
            line += R"(\n)";
            break;
        case '\r':
            line += R"(\r)";
            break;
        default:
            line += each;
        }
    }
    return line += '\n';
}

template <typename Function>
void for_each_file(const SavedMemory& memory, Function function)
{
    for (const SavedItem& item : memory.items) {
        for (const SavedFile& file : item.files) {
            function(place_of(file.name), file.bytes);
        }
    }
}

/// Takes a line from the beginning of SHA256SUMS for each file of the tar, in its order.
Configured<void> check_sums(TarReader files, std::string_view sums, const MemoryLimits& limits)
{
    for (std::size_t count = 0;; ++count) {
        const auto file = files.next();
        if (!file) {
            return Unexpected{file.error()};
        }
        if (!*file) {
            break;
        }
        if (count > limits.max_files) { // one of them is the manifest
            return wrong_backup("found more than " + std::to_string(limits.max_files) + " files");
        }
        const std::string line = sum_line((*file)->name, (*file)->bytes);
        if (!sums.starts_with(line)) {
            return wrong_backup("is damaged: the checksum of " + printable((*file)->name) +
                                " is not the one in SHA256SUMS");
        }
        sums.remove_prefix(line.size());
    }
    return sums.empty() ? Configured<void>{}
                        : wrong_backup("found checksums of files that are not there");
}

Configured<Bytes> take_named(TarReader& files, std::string_view name)
{
    const auto file = files.next();
    if (!file) {
        return Unexpected{file.error()};
    }
    if (!*file || (*file)->name != name) {
        return wrong_backup("found " + (*file ? printable((*file)->name) : "no more files") +
                            ", expected " + printable(name));
    }
    return (*file)->bytes;
}

Configured<SavedMemory> read_tar(Bytes tar, const MemoryLimits& limits)
{
    TarReader files{tar};
    const auto sums = take_named(files, sums_name);
    if (!sums) {
        return Unexpected{sums.error()};
    }
    if (auto checked = check_sums(files, as_text(*sums), limits); !checked) {
        return Unexpected{std::move(checked.error())};
    }
    const auto manifest = take_named(files, manifest_name);
    if (!manifest) {
        return Unexpected{manifest.error()};
    }
    const auto take = [&](const std::string& name, std::size_t size) -> Configured<Bytes> {
        auto bytes = take_named(files, place_of(name));
        if (bytes && bytes->size() != size) {
            return wrong_backup("found " + std::to_string(bytes->size()) + " bytes of " +
                                printable(name) + ", expected " + std::to_string(size));
        }
        return bytes;
    };
    auto memory = read_manifest(*manifest, ManifestForm::WithVersion, limits, take);
    if (!memory) {
        return memory;
    }
    const auto more = files.next();
    if (more && *more) {
        return wrong_backup("found " + printable((*more)->name) +
                            ", which the manifest does not name");
    }
    return more ? std::move(memory) : Unexpected{more.error()};
}

// The earlier format: magic, version and size of the manifest, the manifest, the bytes of all files
// and the CRC-32 of everything before it.

constexpr std::string_view earlier_magic = "BUSBARBK";
constexpr std::uint32_t earlier_version = 1;
constexpr std::size_t number_size = sizeof(std::uint32_t);
constexpr std::size_t earlier_header_size = earlier_magic.size() + 2 * number_size;

std::uint32_t number_at(Bytes bytes, std::size_t at)
{
    std::uint32_t number = 0;
    for (unsigned i = 0; i < number_size; ++i) {
        number |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
    }
    return number;
}

Configured<SavedMemory> read_earlier(Bytes file, const MemoryLimits& limits)
{
    if (file.size() < earlier_header_size + number_size) {
        return wrong_backup("is cut");
    }
    const auto content = file.first(file.size() - number_size);
    if (checksum(content) != number_at(file, content.size())) {
        return wrong_backup("is cut or damaged: the checksum is another one");
    }
    if (const auto version = number_at(file, earlier_magic.size()); version != earlier_version) {
        return wrong_backup("found version " + std::to_string(version) + ", expected " +
                            std::to_string(earlier_version));
    }
    const std::size_t size = number_at(file, earlier_magic.size() + number_size);
    if (size > max_manifest_size || size > content.size() - earlier_header_size) {
        return wrong_backup("found a manifest larger than the file or the limits");
    }
    Bytes rest = content.subspan(earlier_header_size + size);
    const auto take = [&](const std::string& name, std::size_t wanted) -> Configured<Bytes> {
        if (wanted > rest.size()) {
            return wrong_backup("found its end within " + printable(name));
        }
        const auto bytes = rest.first(wanted);
        rest = rest.subspan(wanted);
        return bytes;
    };
    auto memory = read_manifest(content.subspan(earlier_header_size, size), ManifestForm::Earlier,
                                limits, take);
    if (memory && !rest.empty()) {
        return wrong_backup("found " + std::to_string(rest.size()) +
                            " bytes more than the manifest names");
    }
    return memory;
}

} // namespace

std::vector<std::byte> write_backup(const SavedMemory& memory)
{
    const std::string manifest = manifest_of(memory);
    std::string sums = sum_line(manifest_name, as_data(manifest));
    std::size_t size = TarWriter::size_of(manifest_name, manifest.size()) + TarWriter::end_size;
    for_each_file(memory, [&](const std::string& name, Bytes bytes) {
        sums += sum_line(name, bytes);
        size += TarWriter::size_of(name, bytes.size());
    });
    TarWriter tar{memory.label.time.unix_seconds()};
    tar.reserve(size + TarWriter::size_of(sums_name, sums.size()));
    tar.add(sums_name, as_data(sums));
    tar.add(manifest_name, as_data(manifest));
    for_each_file(memory, [&](const std::string& name, Bytes bytes) { tar.add(name, bytes); });
    return tar.take();
}

Configured<SavedMemory> read_backup(std::span<const std::byte> file, const MemoryLimits& limits)
{
    if (file.size() > limits.max_backup_size) {
        return wrong_backup("found " + std::to_string(file.size()) + " bytes, expected at most " +
                            std::to_string(limits.max_backup_size));
    }
    if (as_text(file).starts_with(earlier_magic)) {
        return read_earlier(file, limits);
    }
    return TarReader::is_tar(file)
               ? read_tar(file, limits)
               : wrong_backup("is cut or not a backup file: expected a tar (ustar or "
                              "pax)");
}

} // namespace busbar::controller::detail
