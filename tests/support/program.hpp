#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/types.h>

/// Programs as users and scripts run them: what they print and what they end with.
namespace busbar::test {

using Environment = std::vector<std::pair<std::string, std::string>>;

/// "NAME=value" for each, and for those of `defaults` and for PATH as it is here that have another
/// name.
[[nodiscard]] std::vector<std::string> variables_of(const Environment& environment,
                                                    const Environment& defaults = {});
/// As execve() takes them; valid as long as `texts` is unchanged.
[[nodiscard]] std::vector<char*> pointers_to(std::vector<std::string>& texts);

/// A folder that is gone with the object.
class ScratchFolder {
public:
    ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    ~ScratchFolder();

    [[nodiscard]] const std::string& path() const { return path_; }
    /// Makes or replaces a file in it; its path.
    std::string write(const std::string& name, std::string_view text) const;
    /// Empty if it is not there.
    [[nodiscard]] std::string read(const std::string& name) const;

private:
    std::string path_;
};

/// A program that runs beside the test, with its output in one file. Killed with the object.
class Program {
public:
    static constexpr std::chrono::seconds patience{60};

    /// `command` is the program's file and its arguments; nothing is inherited but PATH if it gives
    /// none. Rights of files count even for the superuser.
    Program(std::vector<std::string> command, const std::string& folder,
            const std::string& output_file, const Environment& environment = {});
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;
    ~Program();

    /// What it has printed so far.
    [[nodiscard]] std::string output() const;
    /// False if that is never there.
    [[nodiscard]] bool wait_for(std::string_view text);
    [[nodiscard]] ::pid_t process() const { return process_; }
    /// The exit code, or 128 and the signal's number; -1 if it does not end.
    [[nodiscard]] int wait_for_end();
    /// Whether it runs, or what it has ended with, for messages.
    [[nodiscard]] std::string end_text();

private:
    bool wait_until(const std::function<bool()>& is_done);
    bool has_ended();

    std::string output_file_;
    ::pid_t process_{-1};
    int status_{-1};
    bool is_over_{false};
};

} // namespace busbar::test
