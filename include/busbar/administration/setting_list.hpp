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

/// Something that administrators may change while a server runs: a number, a switch, a text or a
/// list of these.
struct Setting {
    /// Parts are parted by points: "limits.subscriptions.items".
    std::string name;
    /// What it is for, in a sentence; may be empty.
    std::string description{};
    /// What it is where nobody says otherwise. Never null: its type, scalar or one-dimensional
    /// array of Boolean, Int64, Double or String, is that of all its values.
    Variant otherwise;
    /// Of numbers, also of each in a list; both ends are allowed.
    std::optional<Range> range{};
    /// "ms", "s", "d", "B", "%"; empty: none.
    std::string unit{};
    /// It decides about security: SecurityAdmin changes it, ConfigureAdmin sees it, other roles do
    /// not (Part 3, 4.9.2).
    bool is_security{false};
};

/// Values by the names of settings.
using SettingValues = std::map<std::string, Variant, std::less<>>;

/// Who changed a setting online last, and when.
struct SettingAuthor {
    /// Empty: a Write, or the program itself, of which nobody knows who asked for it.
    std::string user{};
    DateTime time{};

    friend bool operator==(const SettingAuthor&, const SettingAuthor&) = default;
};

/// By the names of settings that were changed; changes of older files have none.
using SettingAuthors = std::map<std::string, SettingAuthor, std::less<>>;

/// One change of a set. Null: the setting is again what it is without changes made online.
struct SettingChange {
    std::string name;
    Variant value;
};

/// What the settings are settings of: a program with its configuration. On the server's thread.
class BUSBAR_API SettingOwner {
public:
    SettingOwner() = default;
    SettingOwner(const SettingOwner&) = delete;
    SettingOwner& operator=(const SettingOwner&) = delete;
    virtual ~SettingOwner() = default;

    /// What the setting is, with the changes that apply() was last given.
    [[nodiscard]] virtual Variant value(const Setting& setting) const = 0;
    /// True if it needs a restart to be in force.
    [[nodiscard]] virtual bool waits_for_restart(const Setting& setting) const = 0;
    /// Whether all of `changes`, on top of what the owner has by itself, make something that works.
    /// Changes nothing. The problem is for who made the change: `where` names what is wrong, and
    /// Bad_InvalidState says that it is nothing but the time.
    [[nodiscard]] virtual Configured<void> check(const SettingValues& changes) = 0;
    /// Takes them on, which were checked and are kept: in force at once as far as that can be.
    virtual void apply(const SettingValues& changes) = 0;
};

/// The settings of a program, and the changes that were made online, kept in a file of a Storage
/// that nothing else writes. A set of changes is checked, written and in force as a whole, or
/// refused and nothing has changed.
///
/// Who has the right to ask for a change is not looked at. On the server's thread.
class BUSBAR_API SettingList {
public:
    /// `storage` must outlive it. The names of `settings` are all different.
    SettingList(Storage& storage, std::string file, std::vector<Setting> settings);

    /// Reads the file; no file is no changes. The problem names the file, what is wrong in it and
    /// what was expected, and nothing changes then. What is read is not applied: the owner is made
    /// with it.
    [[nodiscard]] Configured<void> load();
    /// Removes the file: from the next start on all is as the owner has it by itself. The problem
    /// is one of the Storage.
    [[nodiscard]] Configured<void> forget();

    [[nodiscard]] std::span<const Setting> settings() const { return settings_; }
    /// Null if there is none of this name.
    [[nodiscard]] const Setting* find(std::string_view name) const;
    /// What was changed online.
    [[nodiscard]] const SettingValues& changes() const { return changes_; }
    [[nodiscard]] const SettingAuthors& authors() const { return authors_; }
    /// Makes a set of changes; a later one of a name wins. Bad_NotFound, Bad_TypeMismatch,
    /// Bad_OutOfRange, Bad_ResourceUnavailable if the Storage fails; what the owner refuses is
    /// Bad_InvalidState if it says so, else Bad_InvalidArgument. `where` names the setting, the
    /// text is what was found and expected. `author` is kept with each of them.
    [[nodiscard]] Configured<void> change(std::span<const SettingChange> set, SettingOwner& owner,
                                          const SettingAuthor& author = {});

private:
    Storage* storage_;
    std::string file_;
    std::vector<Setting> settings_; // sorted by name
    SettingValues changes_;
    SettingAuthors authors_;
};

/// Good, Bad_TypeMismatch or Bad_OutOfRange with what was found and expected: the value's type and
/// range, at most 1,000 elements and 65,536 bytes of text each.
[[nodiscard]] BUSBAR_API Configured<void> check_setting(const Setting& setting,
                                                        const Variant& value);

/// The file of a SettingList with these changes and who made them; what load() reads. The same for
/// the same ones.
[[nodiscard]] BUSBAR_API std::string settings_document(const SettingValues& changes,
                                                       const SettingAuthors& authors = {});

} // namespace busbar::administration
