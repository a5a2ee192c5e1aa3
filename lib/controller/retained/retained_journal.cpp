#include "retained_journal.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>

#include "controller/life/checksum.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::uint32_t journal_magic = 0x4A52'4242; // "BBRJ"
constexpr std::uint32_t journal_version = 1;
constexpr std::size_t size_of_size = 4;
constexpr std::size_t size_of_sum = 4;

void add_entry(binary::Writer& writer, const JournalEntry& entry)
{
    writer.number(static_cast<std::uint32_t>(entry.name.size()));
    writer.bytes(std::as_bytes(std::span{entry.name}));
    writer.number(entry.type_print);
    writer.number(entry.offset);
    writer.number(static_cast<std::uint32_t>(entry.bytes.size()));
    writer.bytes(entry.bytes);
}

std::size_t size_of(const JournalEntry& entry)
{
    // Size of two lengths, the offset, the type's print and the contents.
    return 3 * sizeof(std::uint32_t) + sizeof(std::uint64_t) + entry.name.size() +
           entry.bytes.size();
}

std::optional<JournalEntry> read_entry(binary::Reader& reader)
{
    const auto name = reader.bytes(reader.number<std::uint32_t>());
    const auto type_print = reader.number<std::uint64_t>();
    const auto offset = reader.number<std::uint32_t>();
    const auto bytes = reader.bytes(reader.number<std::uint32_t>());
    if (!reader.ok()) {
        return std::nullopt;
    }
    return JournalEntry{
        {reinterpret_cast<const char*>(name.data()), name.size()}, type_print, offset, bytes};
}

/// Encodes a write; the first record of a file follows the file's header.
std::vector<std::byte> record_of(std::span<const JournalEntry> entries, std::uint64_t number,
                                 bool is_first)
{
    std::size_t body = sizeof number + sizeof(std::uint32_t);
    for (const JournalEntry& entry : entries) {
        body += size_of(entry);
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    if (is_first) {
        writer.number(journal_magic);
        writer.number(journal_version);
    }
    const std::size_t begin = writer.written();
    writer.number(static_cast<std::uint32_t>(body));
    writer.number(number);
    writer.number(static_cast<std::uint32_t>(entries.size()));
    for (const JournalEntry& entry : entries) {
        add_entry(writer, entry);
    }
    std::vector<std::byte> record = sink.take(writer.written());
    const std::uint32_t sum = checksum(std::span{record}.subspan(begin));
    for (unsigned shift = 0; shift < 32; shift += 8) {
        record.push_back(static_cast<std::byte>(sum >> shift));
    }
    return record;
}

struct Record {
    std::size_t size;
    bool is_whole; // whether the checksum is right
    std::uint64_t number;
    std::span<const std::byte> entries; // with their number in front
};

/// Reads the first record; nothing if it is incomplete.
std::optional<Record> first_record(std::span<const std::byte> bytes)
{
    binary::Reader reader{bytes};
    const std::size_t size = reader.number<std::uint32_t>();
    const auto body = reader.bytes(size);
    const auto sum = reader.number<std::uint32_t>();
    if (!reader.ok()) {
        return std::nullopt;
    }
    binary::Reader numbered{body};
    const auto number = numbered.number<std::uint64_t>();
    const bool is_right = checksum(bytes.first(size_of_size + size)) == sum;
    return Record{size_of_size + size + size_of_sum, is_right && numbered.ok(), number,
                  numbered.bytes(numbered.remaining())};
}

} // namespace

/// The contents of both files.
struct RetainedJournal::Found {
    std::vector<std::vector<std::byte>> files{};
    /// The bodies of records, by the numbers of their writes.
    std::map<std::uint64_t, std::span<const std::byte>> bodies{};
    std::vector<Problem> problems{};
};

RetainedJournal::RetainedJournal(Storage& storage, const std::string& file)
    : storage_{&storage}, files_{{{.name = file + ".journal-1"}, {.name = file + ".journal-2"}}}
{
}

void RetainedJournal::read(File& file, Found& found) const
{
    const auto problem = [&](std::string text, bool is_damage) {
        found.problems.push_back({.where = file.name, .text = std::move(text)});
        file.is_damaged |= is_damage;
    };
    auto there = read_file(*storage_, file.name, max_size);
    if (!there) {
        if (there.error() != StorageError::NotFound) {
            file.size = 1;
            problem("cannot be read: " + std::string{text(there.error())}, true);
        }
        return;
    }
    const std::span<const std::byte> bytes = found.files.emplace_back(*std::move(there));
    file.size = std::max<std::size_t>(bytes.size(), 1);
    binary::Reader header{bytes};
    const auto found_magic = header.number<std::uint32_t>();
    const auto found_version = header.number<std::uint32_t>();
    if (!header.ok()) {
        return; // cut off before the first record
    }
    if (found_magic != journal_magic || found_version != journal_version) {
        return problem("is not a journal of retained values", true);
    }
    bool was_whole = true;
    for (std::size_t at = header.offset(); at < bytes.size();) {
        const std::string where = "the write at byte " + std::to_string(at);
        const auto record = first_record(bytes.subspan(at));
        if (!record) {
            return problem(where + " was cut off", false);
        }
        if (record->is_whole) {
            found.bodies.emplace(record->number, record->entries);
        } else if (was_whole) {
            problem(where + " is damaged, and is left out", true);
        } else {
            return problem("what comes from byte " + std::to_string(at) + " on is left out", true);
        }
        was_whole = record->is_whole;
        at += record->size;
    }
}

std::vector<Problem> RetainedJournal::recover(std::uint64_t last_saved, Apply apply)
{
    const std::lock_guard lock{mutex_};
    Found found;
    found.files.reserve(files_.size());
    for (File& file : files_) {
        read(file, found);
        error_ = file.size != 0 ? StorageError::Failed : error_;
    }
    last_ = last_saved;
    for (auto each = found.bodies.upper_bound(last_saved); each != found.bodies.end(); ++each) {
        binary::Reader reader{each->second};
        for (auto left = reader.number<std::uint32_t>(); left > 0; --left) {
            const auto entry = read_entry(reader);
            if (!entry) {
                break;
            }
            apply(*entry);
        }
        last_ = each->first;
    }
    return std::move(found.problems);
}

Stored<void> RetainedJournal::append(std::span<const JournalEntry> entries)
{
    const std::lock_guard lock{mutex_};
    if (error_) {
        return not_stored(*error_);
    }
    File& file = files_[active_];
    const auto record = record_of(entries, last_ + 1, file.size == 0);
    // A failed allocation has not written anything; after this a part may be on the medium.
    error_ = StorageError::Full;
    if (record.size() > max_size - file.size) {
        return not_stored(*error_);
    }
    file.size += record.size();
    file.is_unsynced = true;
    if (const auto added = storage_->append_unsynced(file.name, record, FileAccess::Owner);
        !added) {
        error_ = added.error();
        return added;
    }
    error_.reset();
    ++last_;
    return {};
}

bool RetainedJournal::is_empty() const
{
    const std::lock_guard lock{mutex_};
    return files_[0].size == 0 && files_[1].size == 0;
}

bool RetainedJournal::needs_save() const
{
    const std::lock_guard lock{mutex_};
    return error_ || files_[active_].size > usual_size;
}

std::uint64_t RetainedJournal::begin_save()
{
    const std::lock_guard lock{mutex_};
    covers_both_ = error_.has_value();
    if (!error_ && files_[active_].size != 0 && files_[1 - active_].size == 0) {
        active_ = 1 - active_;
    }
    return last_;
}

Stored<void> RetainedJournal::remove(File& file)
{
    if (file.size == 0) {
        return {};
    }
    const auto gone = file.is_damaged
                          ? storage_->move(file.name, file.name + ".kept", WhenThere::Replace)
                          : storage_->remove(file.name);
    if (!gone && gone.error() != StorageError::NotFound) {
        return gone;
    }
    file = {.name = file.name};
    return {};
}

Stored<void> RetainedJournal::saved()
{
    File& other = files_[1 - active_];
    // Writes go to the active file in the meantime, unless they are refused.
    File gone = other;
    if (auto removed = remove(gone); !removed) {
        return removed;
    }
    const std::lock_guard lock{mutex_};
    other = gone;
    if (!covers_both_) {
        return {};
    }
    if (auto removed = remove(files_[active_]); !removed) {
        return removed;
    }
    error_.reset();
    return {};
}

Stored<void> RetainedJournal::sync()
{
    for (File& file : files_) {
        std::unique_lock lock{mutex_};
        if (!std::exchange(file.is_unsynced, false)) {
            continue;
        }
        lock.unlock();
        if (auto synced = storage_->sync(file.name); !synced) {
            lock.lock();
            file.is_unsynced = true;
            return synced;
        }
    }
    return {};
}

} // namespace busbar::controller::detail
