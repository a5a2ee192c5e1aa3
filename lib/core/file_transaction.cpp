#include <busbar/core/file_transaction.hpp>

#include <algorithm>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "json.hpp"
#include "json_writer.hpp"

namespace busbar {

namespace {

using detail::Json;

constexpr std::size_t max_journal_size = 4U << 20U;
constexpr std::size_t max_staged_files = 100'000;

std::string_view folder_of(std::string_view name)
{
    const std::size_t slash = name.rfind('/');
    return slash == std::string_view::npos ? std::string_view{} : name.substr(0, slash);
}

/// Returns the text of the journal that names a file.
const std::string* name_in(const Json& step, std::string_view member)
{
    const Json* const found = step.find(member);
    return found != nullptr && found->kind == Json::Kind::String && is_storage_name(found->text)
               ? &found->text
               : nullptr;
}

/// A step that was done already finds nothing.
Stored<void> unless_gone(Stored<void> done)
{
    return !done && done.error() == StorageError::NotFound ? Stored<void>{} : done;
}

} // namespace

FileTransaction::FileTransaction(Storage& storage, std::string folder)
    : storage_{&storage}, folder_{std::move(folder)}
{
}

FileTransaction::~FileTransaction()
{
    if (!is_decided_) {
        cancel();
    }
}

void FileTransaction::set(std::string_view name, std::string staged)
{
    const auto found = std::find_if(steps_.begin(), steps_.end(),
                                    [&](const Step& step) { return step.name == name; });
    if (found == steps_.end()) {
        steps_.push_back({std::string{name}, std::move(staged)});
        return;
    }
    if (!found->staged.empty()) {
        static_cast<void>(storage_->remove(found->staged)); // else recover() does it
    }
    found->staged = std::move(staged);
}

Stored<void> FileTransaction::replace(std::string_view name, std::span<const std::byte> bytes,
                                      FileAccess access)
{
    if (!is_storage_name(name)) {
        return not_stored(StorageError::BadName);
    }
    if (const auto there = storage_->list(folder_of(name), 0); !there) {
        return not_stored(there.error());
    }
    // Once the transaction is decided nothing may obstruct it.
    if (const auto there = storage_->entry(name);
        there && there->kind == StorageEntry::Kind::Folder) {
        return not_stored(StorageError::Failed);
    }
    if (auto finished = finish_earlier(); !finished) {
        return finished;
    }
    if (auto made = storage_->make_folder(folder_, FileAccess::Owner); !made) {
        return made;
    }
    std::string staged = storage_path(folder_, std::to_string(next_number_) + ".new");
    if (auto written = storage_->replace(staged, bytes, access); !written) {
        return written;
    }
    ++next_number_;
    set(name, std::move(staged));
    return {};
}

Stored<void> FileTransaction::remove(std::string_view name)
{
    if (!is_storage_name(name)) {
        return not_stored(StorageError::BadName);
    }
    set(name, {});
    return {};
}

Stored<void> FileTransaction::commit()
{
    if (steps_.empty()) {
        return {};
    }
    if (auto finished = finish_earlier(); !finished) {
        return finished;
    }
    detail::JsonWriter json;
    json.begin_list();
    for (const Step& step : steps_) {
        json.begin_object();
        json.name("name");
        json.string(step.name);
        if (!step.staged.empty()) {
            json.name("staged");
            json.string(step.staged);
        }
        json.end_object();
    }
    json.end_list();
    const std::string document = json.take();
    if (auto made = storage_->make_folder(folder_, FileAccess::Owner); !made) {
        return made;
    }
    if (auto decided =
            storage_->replace(journal(), std::as_bytes(std::span{document}), FileAccess::Owner);
        !decided) {
        return decided;
    }
    is_decided_ = true;
    is_first_ = false;
    return carry_out(std::exchange(steps_, {}));
}

/// Carries out the steps, each of which can be repeated.
Stored<void> FileTransaction::carry_out(const std::vector<Step>& steps)
{
    for (const Step& step : steps) {
        auto done = unless_gone(step.staged.empty()
                                    ? storage_->remove(step.name)
                                    : storage_->move(step.staged, step.name, WhenThere::Replace));
        if (!done) {
            return done;
        }
    }
    if (auto done = unless_gone(storage_->remove(journal())); !done) {
        return done;
    }
    is_decided_ = false;
    return {};
}

Stored<std::vector<FileTransaction::Step>> FileTransaction::read_journal() const
{
    const auto bytes = read_file(*storage_, journal(), max_journal_size);
    if (!bytes) {
        return not_stored(bytes.error());
    }
    const auto json =
        detail::parse_json({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    if (!json || json->kind != Json::Kind::List) {
        return not_stored(StorageError::Failed);
    }
    std::vector<Step> steps;
    for (const Json& item : json->items) {
        const std::string* const name = name_in(item, "name");
        const bool is_staged = item.find("staged") != nullptr;
        const std::string* const staged = name_in(item, "staged");
        // Only files in the transaction's folder are ever moved.
        if (name == nullptr ||
            (is_staged && (staged == nullptr || folder_of(*staged) != folder_))) {
            return not_stored(StorageError::Failed);
        }
        steps.push_back({*name, is_staged ? *staged : std::string{}});
    }
    return steps;
}

Stored<void> FileTransaction::recover()
{
    steps_.clear();
    is_first_ = false;
    return finish_earlier();
}

/// An earlier transaction's files in the folder have the names that this one's would get.
Stored<void> FileTransaction::finish_earlier()
{
    if (is_first_) {
        return {};
    }
    auto steps = read_journal();
    if (!steps && steps.error() != StorageError::NotFound) {
        return not_stored(steps.error());
    }
    if (steps) {
        if (auto done = carry_out(*steps); !done) {
            return done;
        }
    }
    is_decided_ = false;
    is_first_ = true;
    forget_staged();
    return {};
}

void FileTransaction::cancel()
{
    for (const Step& step : std::exchange(steps_, {})) {
        if (!step.staged.empty()) {
            // If this fails, recover() does it; this is the end of a destructor.
            detail::attempt([&] { static_cast<void>(storage_->remove(step.staged)); });
        }
    }
}

void FileTransaction::forget_staged()
{
    storage_->remove_unfinished(folder_);
    const auto left = storage_->list(folder_, max_staged_files);
    if (!left) {
        return;
    }
    for (const StorageEntry& entry : left->entries) {
        if (entry.kind == StorageEntry::Kind::File && entry.name != "journal.json") {
            static_cast<void>(storage_->remove(storage_path(folder_, entry.name)));
        }
    }
}

} // namespace busbar
