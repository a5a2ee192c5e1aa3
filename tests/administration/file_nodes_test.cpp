#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/harness/bench.hpp>
#include <busbar/harness/report.hpp>
#include <busbar/server/running_server.hpp>

#include "administration/file_nodes.hpp"

#include "files_fixture.hpp"

namespace file_nodes_test {

// Part 20, 4.2 and 4.3: files and directories as clients see them.

using namespace busbar;
using namespace busbar::test;

TEST_CASE_METHOD(FilesFixture, "file nodes: files and folders are made, written and read")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    CHECK(make_folder(client, "", "press") == "Good");
    const auto made = on(client, "press", "CreateFile", {Variant{String{"4.csv"}}, Variant{true}});
    REQUIRE(made.status_code == status::Good);
    CHECK(made.output_arguments[0] == Variant{node("press/4.csv")});
    CHECK(value(client, "press/4.csv", "OpenCount").value == Variant{std::uint16_t{1}});
    CHECK(why(client, "press/4.csv", "Close", {made.output_arguments[1]}) == "Good");
    write(client, "press/4.csv", "speed;7");
    CHECK(names(client) == Names{"press"});
    // Part 20, 4.3.2.
    const auto& space = server.address_space();
    const auto path = [&](std::uint32_t parent, std::string_view name) {
        bool is_there = false;
        space.for_each_child(
            space.find(parent), space.find(id::HierarchicalReferences), true,
            QualifiedName{parent == id::FileSystem ? std::uint16_t{1} : std::uint16_t{0},
                          String{name}},
            [&](model::NodeIndex) { return !(is_there = true); });
        return is_there;
    };
    CHECK(path(id::ObjectsFolder, "FileSystem"));
    CHECK(path(id::FileSystem, "recipes"));
    CHECK(name(call(client, NodeId{0, id::FileSystem}, NodeId{0, 16348}, {Variant{String{"x"}}})
                   .status_code) == "Bad_NodeIdUnknown");
    CHECK(names(client, "press") == Names{"4.csv"});
    CHECK(value(client, "press/4.csv", "Size").value == Variant{std::uint64_t{7}});
    CHECK(value(client, "press/4.csv", "Writable").value == Variant{true});
    CHECK(value(client, "press/4.csv", "LastModifiedTime").status == status::Good);
    auto reader = log_in_as("op");
    CHECK(text(reader, "press/4.csv") == "speed;7");
    const Variant handle = open(reader, "press/4.csv", reading);
    CHECK(why(reader, "press/4.csv", "SetPosition", {handle, Variant{std::uint64_t{3}}}) == "Good");
    CHECK(on(reader, "press/4.csv", "GetPosition", {handle}).output_arguments[0] ==
          Variant{std::uint64_t{3}});
    CHECK(why(client, "press/4.csv", "Close", {handle}) == "Bad_InvalidArgument"); // another's
    const Variant own = open(client, "press/4.csv", reading);
    CHECK(why(client, "press/4.csv", "Open", {Variant{writing}}) == "Bad_NotWritable");
    CHECK(why(client, "press/4.csv", "Close", {own}) == "Good");
}

TEST_CASE_METHOD(FilesFixture, "file nodes: who reads a file keeps nobody from changing it")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    REQUIRE(make_folder(client, "", "press") == "Good");
    for (const char* name : {"a", "b"}) {
        REQUIRE(make(client, "press", name) == "Good");
        write(client, std::string{"press/"} + name, "first");
    }
    auto reader = log_in_as("op");
    const Variant handle = open(reader, "press/a", reading);
    write(client, "press/a", "second");
    CHECK(text(client, "press/a") == "second");
    const auto read = on(reader, "press/a", "Read", {handle, Variant{std::int32_t{10}}});
    CHECK(read.output_arguments[0] == Variant{ByteString{std::as_bytes(std::span{"first", 5})}});
    CHECK(why(reader, "press/a", "Close", {handle}) == "Good");

    const Variant of_moved = open(reader, "press/a", reading);
    const Variant of_deleted = open(reader, "press/b", reading);
    CHECK(move(client, "press", "press/a", "", "c") == "Good");
    CHECK(why(client, "press", "Delete", {Variant{node("press/b")}}) == "Good");
    // They are gone with the files, also for those that come after them.
    REQUIRE(make(client, "press", "a") == "Good");
    CHECK(why(reader, "press/a", "Close", {of_moved}) == "Bad_InvalidArgument");
    REQUIRE(make(client, "press", "b") == "Good");
    CHECK(why(reader, "press/b", "Close", {of_deleted}) == "Bad_InvalidArgument");
    CHECK(value(client, "press/b", "OpenCount").value == Variant{std::uint16_t{0}});
}

TEST_CASE_METHOD(FilesFixture, "file nodes: a user with many sessions leaves others their handles")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    REQUIRE(make(client, "", "a") == "Good");
    std::vector<TestClient> readers;
    for (int i = 0; i < 4; ++i) {
        readers.push_back(log_in_as("op"));
        for (int k = 0; k < 8; ++k) {
            static_cast<void>(open(readers.back(), "a", reading));
        }
    }
    auto more = log_in_as("op");
    CHECK(why(more, "a", "Open", {Variant{reading}}) == "Bad_TooManyOperations");
    write(client, "a", "still possible");
    CHECK(on(client, "", "CreateFile", {Variant{String{"b"}}, Variant{true}}).status_code ==
          status::Good);
}

TEST_CASE_METHOD(FilesFixture, "file nodes: say how much of a file a call may have")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    REQUIRE(make(client, "", "4.csv") == "Good");
    CHECK(value(client, "4.csv", "MaxByteStringLength").value == Variant{std::uint32_t{65'536}});
    // Never more than a request may have (Part 5, 6.3.2).
    auto config = server.config();
    config.limits.decode.max_byte_string_length = 10'240;
    REQUIRE(server::RunningServer{server}.reconfigure(config));
    CHECK(value(client, "4.csv", "MaxByteStringLength").value == Variant{std::uint32_t{10'240}});
}

TEST_CASE_METHOD(FilesFixture, "file nodes: names that are none, or taken, are refused")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    for (const char* bad : {"", ".", "..", "../x", "a/b", "a\\b", ".hidden", "a\nb", "/etc", " ",
                            "a ", "\xe2\x80\xaetxt.exe"}) {
        INFO(bad);
        CHECK(make(client, "", bad) == "Bad_BrowseNameInvalid");
        CHECK(make_folder(client, "", bad) == "Bad_BrowseNameInvalid");
    }
    CHECK(make(client, "", std::string(256, 'x').c_str()) == "Bad_BrowseNameInvalid");
    CHECK(make(client, "", "a") == "Good");
    CHECK(make(client, "", "a") == "Bad_BrowseNameDuplicated");
    CHECK(make_folder(client, "", "a") == "Bad_BrowseNameDuplicated");
    // Somebody else's, that no node was made of yet.
    REQUIRE(file_storage.replace("b", {}, FileAccess::Owner));
    CHECK(make(client, "", "b") == "Bad_BrowseNameDuplicated");
    CHECK(make(client, "a", "c") == "Bad_MethodInvalid"); // no folder
}

TEST_CASE_METHOD(FilesFixture,
                 "file nodes: what others call as no client may is not shown, and told")
{
    REQUIRE(file_storage.make_folder("\xff", FileAccess::Owner));
    for (const char* name : {"a", "b\xff", "\xe2\x80\xaetxt.exe", ".hidden", "\xff/c"}) {
        REQUIRE(file_storage.replace(name, {}, FileAccess::Owner));
    }
    auto client = log_in_as("eng");
    log.text.clear();
    CHECK(make(client, "", "d") == "Good");
    CHECK(names(client) == Names{"a", "d"});
    CHECK(make(client, "", "e") == "Good");
    const auto told = log.text.find("clients cannot see \"");
    CHECK(told != std::string::npos);
    CHECK(log.text.find("clients cannot see \"", told + 1) == std::string::npos); // once
    CHECK(log.text.find('\xff') == std::string::npos);
    CHECK(log.text.find(".hidden") == std::string::npos);
}

TEST_CASE_METHOD(FilesFixture,
                 "file nodes: what a power cut left half written is gone at the next start")
{
    REQUIRE(file_storage.make_folder("press", FileAccess::Owner));
    for (const char* name : {"a", "press/4.csv"}) {
        storage.cut_power_after(1);
        CHECK_FALSE(
            file_storage.replace(name, std::as_bytes(std::span{"half", 4}), FileAccess::Owner));
        storage.restore_power();
    }
    REQUIRE(storage.unfinished().size() == 2);
    auto others = files;
    others.name = "again";
    administration::detail::FileNodes nodes{server, others, wall_clock, log};
    REQUIRE(nodes.add_nodes());
    CHECK(storage.unfinished().empty());
}

TEST_CASE_METHOD(FilesFixture, "file nodes: are moved, copied and removed")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    CHECK(make_folder(client, "", "from") == "Good");
    CHECK(make_folder(client, "", "to") == "Good");
    CHECK(make(client, "from", "a") == "Good");
    write(client, "from/a", "one");
    CHECK(move(client, "from", "from/a", "to", "", true) == "Good");
    CHECK(text(client, "to/a") == "one");
    CHECK(text(client, "from/a") == "one");
    CHECK(move(client, "from", "from/a", "to") == "Bad_BrowseNameDuplicated");
    CHECK(move(client, "from", "from/a", "to", "b") == "Good");
    CHECK(names(client, "from").empty());
    CHECK(names(client, "to") == Names{"a", "b"});
    CHECK(move(client, "from", "to/a", "from") == "Bad_NotFound"); // not in it
    CHECK(move(client, "", "to", "to") == "Bad_InvalidArgument");  // into itself
    CHECK(move(client, "", "to", "from", "deep") == "Good");
    CHECK(text(client, "from/deep/b") == "one");
    CHECK(move(client, "", "from", "", "second", true) == "Good");
    CHECK(text(client, "second/deep/b") == "one");

    const auto remove = [&](const std::string& folder, const std::string& what) {
        return why(client, folder, "Delete", {Variant{node(what)}});
    };
    const Variant handle = open(client, "from/deep/a", reading);
    CHECK(remove("", "from") == "Bad_InvalidState");
    CHECK(move(client, "", "from", "", "other") == "Bad_InvalidState");
    CHECK(why(client, "from/deep/a", "Close", {handle}) == "Good");
    CHECK(remove("", "from/deep") == "Bad_NotFound");
    CHECK(remove("", "") == "Bad_NotFound");
    CHECK(remove("", "from") == "Good");
    CHECK_FALSE(is_stored("from"));
    CHECK(is_stored("second/deep/b"));
    CHECK(names(client) == Names{"second"});
    CHECK(value(client, "from/deep/a", "Size").status == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(FilesFixture, "file nodes: readers read, writers write, others see nothing")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto engineer = log_in_as("eng");
    CHECK(make(engineer, "", "a") == "Good");
    auto reader = log_in_as("op");
    CHECK(why(reader, "a", "Open", {Variant{writing}}) == "Bad_UserAccessDenied");
    CHECK(why(reader, "a", "Open", {Variant{std::uint8_t{3}}}) == "Bad_UserAccessDenied");
    CHECK(make(reader, "", "b").starts_with("Bad_"));
    CHECK_FALSE(is_stored("b"));
    CHECK(why(reader, "", "Delete", {Variant{node("a")}}).starts_with("Bad_"));
    CHECK(is_stored("a"));
    auto looker = log_in_as("looker");
    CHECK(why(looker, "a", "Open", {Variant{reading}}) == "Bad_NodeIdUnknown");
    CHECK(names(looker).empty());
    auto signed_only = log_in("eng", "patience is all", MessageSecurityMode::Sign);
    CHECK(why(signed_only, "a", "Open", {Variant{reading}}) == "Bad_SecurityModeInsufficient");
}

TEST_CASE_METHOD(FilesFixture, "file nodes: how many there may be is limited")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    CHECK(make_folder(client, "", "1") == "Good");
    CHECK(make_folder(client, "1", "2") == "Good");
    CHECK(make_folder(client, "1/2", "3") == "Good");
    CHECK(make_folder(client, "1/2/3", "4") == "Bad_ResourceUnavailable");
    for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h", "i"}) {
        CHECK(make(client, "", name) == "Good");
    }
    CHECK(make(client, "", "j") == "Bad_ResourceUnavailable");
    CHECK(move(client, "", "1", "", "j", true) == "Bad_ResourceUnavailable");
    CHECK_FALSE(is_stored("j"));
    // What others put there beyond it is not shown.
    REQUIRE(file_storage.replace("1/z", {}, FileAccess::Owner));
    CHECK(why(client, "", "Delete", {Variant{node("i")}}) == "Good");
    CHECK(names(client, "1").size() == 2);
}

TEST_CASE_METHOD(FilesFixture, "file nodes: follow what others than clients do")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    const auto refresh = [&] {
        administration->refresh_files();
        complete();
    };
    REQUIRE(file_storage.replace("log", {}, FileAccess::Owner));
    CHECK(names(client).empty());
    refresh();
    CHECK(names(client) == Names{"log"});
    REQUIRE(file_storage.remove("log"));
    REQUIRE(file_storage.replace("log 2", {}, FileAccess::Owner));
    refresh();
    CHECK(names(client) == Names{"log 2"});
    storage.set_away(true); // what cannot be read now is not gone
    refresh();
    CHECK(names(client) == Names{"log 2"});
}

TEST_CASE_METHOD(FilesFixture, "file nodes: a session that ends writes nothing")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    CHECK(make(client, "", "a") == "Good");
    write(client, "a", "first");
    {
        auto other = log_in_as("eng");
        const Variant handle = open(other, "a", writing);
        CHECK(why(other, "a", "Write",
                  {handle, Variant{ByteString{std::as_bytes(std::span{"half", 4})}}}) == "Good");
        CHECK(why(client, "a", "Open", {Variant{reading}}) == "Bad_NotReadable");
        other.close_session();
    }
    CHECK(text(client, "a") == "first");
}

TEST_CASE_METHOD(FilesFixture, "file nodes: what was written is not kept without the right to")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    CHECK(make(client, "", "a") == "Good");
    write(client, "a", "first");
    const Variant half{ByteString{std::as_bytes(std::span{"half", 4})}};

    // The right is taken away between Write and Close.
    auto other = log_in_as("eng");
    Variant handle = open(other, "a", writing);
    CHECK(why(other, "a", "Write", {handle, half}) == "Good");
    REQUIRE(user_list.modify("eng", {.roles = std::vector<std::string>{"Operator"}}, random));
    server::RunningServer{server}.roles_changed();
    CHECK(other.activate(other.user("eng", "patience is all")) == status::Good);
    CHECK(why(other, "a", "Close", {handle}) != "Good");
    CHECK(text(client, "a") == "first");
    REQUIRE(user_list.modify("eng", {.roles = std::vector<std::string>{"Engineer"}}, random));

    // The session gets another user, who may write too.
    auto third = log_in_as("eng");
    handle = open(third, "a", writing);
    CHECK(why(third, "a", "Write", {handle, half}) == "Good");
    CHECK(third.activate(third.user("op", "patience is all")) == status::Good);
    CHECK(why(third, "a", "Close", {handle}) == "Bad_InvalidArgument");
    CHECK(third.activate(third.user("eng", "patience is all")) == status::Good);
    CHECK(why(third, "a", "Close", {handle}) == "Bad_InvalidArgument");
    CHECK(text(client, "a") == "first");
    CHECK(value(client, "a", "OpenCount").value == Variant{std::uint16_t{0}});
}

TEST_CASE_METHOD(FilesFixture, "file nodes: a Call of many is served in turns")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    auto other = log_in_as("eng");
    const auto request = [](const std::vector<const char*>& names) {
        CallRequest all;
        for (const char* name : names) {
            CallMethodRequest each;
            each.object_id = node();
            each.method_id = folder_method("CreateFile");
            each.input_arguments = {Variant{String{name}}, Variant{false}};
            all.methods_to_call.push_back(each);
        }
        return all;
    };
    // One Method at a time, and another session in between.
    const auto many = client.send(request({"a", "b", "c", "d"}));
    CHECK((is_stored("a") && !is_stored("b")));
    const auto one = other.send(request({"z"}));
    CHECK(is_stored("z"));
    CHECK(other.take<CallResponse>(one));
    const auto few = other.send(request({"y", "x"}));
    const auto more = other.send(request({"w"})); // behind what the session has waiting
    CHECK((is_stored("y") && !is_stored("x") && !is_stored("w")));
    const auto turn = [&] {
        REQUIRE(std::exchange(waker.is_awake, false));
        server.handle_completions(now);
    };
    turn();
    turn();
    CHECK((is_stored("b") && is_stored("x") && !is_stored("c") && !is_stored("w")));
    complete();
    CHECK((is_stored("c") && is_stored("d") && is_stored("w")));
    for (const auto& [whose, id] : {std::pair{&client, many}, {&other, few}, {&other, more}}) {
        const auto response = whose->take<CallResponse>(id);
        REQUIRE(response);
        for (const CallMethodResult& result : response->results) {
            CHECK(name(result.status_code) == "Good");
        }
    }

    // Waiting Methods are dropped when their session ends or gets another user.
    client.send(request({"e", "f", "g"}));
    other.send(request({"h", "i"}));
    client.close_session();
    CHECK(other.activate(other.user("op", "patience is all")) == status::Good);
    complete();
    CHECK((is_stored("e") && !is_stored("f") && !is_stored("g")));
    CHECK((is_stored("h") && !is_stored("i")));
}

TEST_CASE_METHOD(FilesFixture, "file nodes: a medium that is away or protected loses nothing")
{
    REQUIRE(file_storage.make_folder("", FileAccess::Owner));
    auto client = log_in_as("eng");
    CHECK(make(client, "", "a") == "Good");
    write(client, "a", "first");
    storage.set_protected(true);
    CHECK(make(client, "", "b") == "Bad_ResourceUnavailable");
    CHECK(why(client, "", "Delete", {Variant{node("a")}}) == "Bad_ResourceUnavailable");
    CHECK(move(client, "", "a", "", "c") == "Bad_ResourceUnavailable");
    storage.set_protected(false);
    CHECK(names(client) == Names{"a"});
    CHECK(text(client, "a") == "first");
    storage.set_away(true);
    CHECK(value(client, "a", "Size").status == status::Bad_ResourceUnavailable);
    CHECK(why(client, "a", "Open", {Variant{reading}}) == "Bad_ResourceUnavailable");
    // A medium that comes back has what it had.
    CHECK(why(client, "", "Delete", {Variant{node("a")}}) == "Bad_ResourceUnavailable");
    CHECK(names(client) == Names{"a"});
    storage.set_away(false);
    CHECK(text(client, "a") == "first");
}

namespace {

/// Files that only the program writes, such as logs, on a server of their own.
struct ProgramFiles : FilesFixture {
    ProgramFiles()
    {
        REQUIRE(more.attach(other.server()));
        REQUIRE(file_storage.make_folder("", FileAccess::Owner));
        for (const char* name : {"a", "b"}) {
            REQUIRE(
                file_storage.replace(name, std::as_bytes(std::span{"text", 4}), FileAccess::Owner));
        }
        more.refresh_files();
    }
    [[nodiscard]] harness::BenchOptions options()
    {
        harness::BenchOptions options;
        options.server = harness::secured_server_config();
        options.server_parts.users = &passwords;
        options.server_parts.roles = &roles;
        return options;
    }
    std::string_view ask(const char* user, const std::string& path, const char* method,
                         const std::vector<Variant>& inputs)
    {
        const bool is_admin = std::string_view{user} == "admin";
        harness::BenchClient& client =
            other.log_in(client::NamedUser{user, is_admin ? "admin-secret!" : "patience is all"},
                         setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt));
        const auto result =
            client.call(node(path), path.empty() ? folder_method(method) : file_method(method),
                        Array<Variant>{inputs});
        client.host().close();
        return name(harness::need(result).status_code);
    }

    /// The file that the program is writing.
    std::string current;
    harness::World world;
    administration::Administration more{{.wall_clock = &world.clock(),
                                         .log = &log,
                                         .roles = &roles,
                                         .file_systems = {[this] {
                                             auto written = files;
                                             written.is_written_by_program = true;
                                             written.may_delete = [this](std::string_view path) {
                                                 return path != current && path != "folder";
                                             };
                                             written.begin_new_file = [this] {
                                                 current = "b";
                                                 return Stored<void>{};
                                             };
                                             return written;
                                         }()}}};
    harness::Bench other{world, options()};
};

} // namespace

TEST_CASE_METHOD(ProgramFiles,
                 "file nodes: of what the program writes clients only read and delete", "[attack]")
{
    const Variant name_of_new{String{"c"}};
    for (const char* user : {"admin", "op", "looker", "eng"}) {
        INFO(user);
        const auto refused = [&](const char* path, const char* method,
                                 const std::vector<Variant>& inputs) {
            const auto answer = ask(user, path, method, inputs);
            INFO(method << ": " << answer);
            CHECK((answer == "Bad_UserAccessDenied" || answer == "Bad_NodeIdUnknown"));
        };
        refused("", "CreateFile", {name_of_new, Variant{false}});
        refused("", "CreateDirectory", {name_of_new});
        refused("", "MoveOrCopy",
                {Variant{node("a")}, Variant{node()}, Variant{true}, name_of_new});
        refused("a", "Write", {Variant{std::uint32_t{1}}, Variant{ByteString{}}});
    }
    CHECK(ask("op", "a", "Open", {Variant{reading}}) == "Good");
    CHECK(ask("eng", "a", "Open", {Variant{writing}}) != "Good");
    CHECK(ask("op", "", "Delete", {Variant{node("a")}}) != "Good");
    CHECK(file_storage.entry("a"));
    CHECK(ask("eng", "", "Delete", {Variant{node("a")}}) == "Good");
    CHECK((!file_storage.entry("a") && file_storage.entry("b") && !file_storage.entry("c")));
}

TEST_CASE_METHOD(ProgramFiles,
                 "file nodes: the file that the program is writing stays, whoever deletes",
                 "[attack]")
{
    const auto begin = [&](const char* user) { return ask(user, "", "BeginNewFile", {}); };
    REQUIRE(file_storage.make_folder("folder", FileAccess::Owner));
    more.refresh_files();
    current = "a";
    for (const char* user : {"admin", "op", "looker", "eng"}) {
        for (const char* kept : {"a", "folder"}) {
            INFO(user << " deletes " << kept);
            CHECK(ask(user, "", "Delete", {Variant{node(kept)}}) != "Good");
            CHECK(file_storage.entry(kept));
        }
        CHECK((begin(user) == "Good") == (std::string_view{user} == "eng"));
    }
    CHECK(ask("eng", "", "Delete", {Variant{node("a")}}) == "Good"); // is complete now
    CHECK(ask("eng", "", "Delete", {Variant{node("b")}}) == "Bad_InvalidState");
    CHECK(file_storage.entry("b"));
    // A folder that says nothing of that has no such Method.
    auto eng = log_in_as("eng");
    CHECK(call(eng, node(), folder_method("BeginNewFile"), {}).status_code.is_bad());
}

} // namespace file_nodes_test
