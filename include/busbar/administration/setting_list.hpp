#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::administration {

/// A value that administrators may change while a server runs: a number, a switch, a text or a list
/// of these.
struct Setting {
    /// Parts are separated by dots: "limits.subscriptions.items".
    std::string name;
    /// Its purpose, in a sentence; may be empty.
    std::string description{};
    /// The default value. Never null: its type, scalar or one-dimensional array of Boolean, Int64,
    /// Double or String, is that of all its values.
    Variant otherwise;
    /// The range of numbers, also of each in a list; both ends are allowed.
    std::optional<Range> range{};
    /// "ms", "s", "d", "B", "%"; empty for none.
    std::string unit{};
    /// It concerns security: SecurityAdmin changes it, ConfigureAdmin sees it, other roles do not
    /// (Part 3, 4.9.2).
    bool is_security{false};
};

/// Values by names of settings.
using SettingValues = std::map<std::string, Variant, std::less<>>;

/// The user who changed a setting online last, and the time.
struct SettingAuthor {
    /// Empty for a Write, or for the program itself, whose user is unknown.
    std::string user{};
    DateTime time{};

    friend bool operator==(const SettingAuthor&, const SettingAuthor&) = default;
};

/// Authors by the names of changed settings; changes of older files have no author.
using SettingAuthors = std::map<std::string, SettingAuthor, std::less<>>;

/// One change of a set. Null: the setting has its value without online changes again.
struct SettingChange {
    std::string name;
    Variant value;
};

/// The program whose settings these are, with its configuration. Called on the server's thread.
class BUSBAR_API SettingOwner {
public:
    SettingOwner() = default;
    SettingOwner(const SettingOwner&) = delete;
    SettingOwner& operator=(const SettingOwner&) = delete;
    virtual ~SettingOwner() = default;

    /// Returns the setting's value with the changes of the last apply().
    [[nodiscard]] virtual Variant value(const Setting& setting) const = 0;
    /// Returns true if a change takes effect only after a restart.
    [[nodiscard]] virtual bool waits_for_restart(const Setting& setting) const = 0;
    /// Checks whether all of `changes`, applied to the owner's own configuration, result in a valid
    /// one. Changes nothing. The problem is for the user who made the change: `where` names what is
    /// wrong, and Bad_InvalidState means that only the time is wrong.
    [[nodiscard]] virtual Configured<void> check(const SettingValues& changes) = 0;
    /// Applies changes that were checked and stored, at once as far as possible.
    virtual void apply(const SettingValues& changes) = 0;
};

/// The settings of a program, and the changes that were made online, kept in a file of a Storage
/// that nothing else writes. A set of changes is checked, written and put in force completely, or
/// refused without any effect.
///
/// Does not check the right to make a change. Used on the server's thread.
class BUSBAR_API SettingList {
public:
    /// `storage` must outlive it. The names of `settings` are unique.
    SettingList(Storage& storage, std::string file, std::vector<Setting> settings);

    /// Reads the file; without a file there are no changes. The problem names the file, the error
    /// in it and what was expected, and nothing changes then. The changes are not applied: the
    /// owner is created with them.
    [[nodiscard]] Configured<void> load();
    /// Removes the file: from the next start on the owner's own configuration is in force. The
    /// problem is one of the Storage.
    [[nodiscard]] Configured<void> forget();

    [[nodiscard]] std::span<const Setting> settings() const { return settings_; }
    /// Returns null if there is none with this name.
    [[nodiscard]] const Setting* find(std::string_view name) const;
    /// The changes that were made online.
    [[nodiscard]] const SettingValues& changes() const { return changes_; }
    [[nodiscard]] const SettingAuthors& authors() const { return authors_; }
    /// Makes a set of changes; a later one of the same name wins. Bad_NotFound, Bad_TypeMismatch,
    /// Bad_OutOfRange, Bad_ResourceUnavailable if the Storage fails; a change that the owner
    /// refuses is Bad_InvalidState if it says so, else Bad_InvalidArgument. `where` names the
    /// setting, the text says what was found and expected. `author` is kept with each of them.
    [[nodiscard]] Configured<void> change(std::span<const SettingChange> set, SettingOwner& owner,
                                          const SettingAuthor& author = {});

private:
    Storage* storage_;
    std::string file_;
    std::vector<Setting> settings_; // sorted by name
    SettingValues changes_;
    SettingAuthors authors_;
};

/// Returns Good, Bad_TypeMismatch or Bad_OutOfRange with what was found and expected: checks the
/// value's type and range, at most 1,000 elements and 65,536 bytes of text each.
[[nodiscard]] BUSBAR_API Configured<void> check_setting(const Setting& setting,
                                                        const Variant& value);

/// Returns the file of a SettingList with these changes and their authors, which load() reads.
/// Equal arguments yield equal bytes.
[[nodiscard]] BUSBAR_API std::string settings_document(const SettingValues& changes,
                                                       const SettingAuthors& authors = {});

} // namespace busbar::administration
