#include <algorithm>
#include <array>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <busbar/crypto/secret.hpp>
#include <busbar/types/data_types.hpp>

#include "managed_fixture.hpp"

namespace user_management_test {

using namespace busbar;
using namespace busbar::test;

namespace {

struct Users : ManagedFixture {
    using ManagedFixture::ManagedFixture;

    std::string_view call_user(TestClient& client, std::uint32_t method,
                               std::vector<Variant> inputs)
    {
        return name(
            call(client, NodeId{0, id::UserManagement}, NodeId{0, method}, std::move(inputs))
                .status_code);
    }
    std::string_view add(TestClient& client, const char* name, const char* password,
                         std::uint32_t bits = 0)
    {
        return call_user(client, id::UserManagement_AddUser,
                         {Variant{String{name}}, Variant{String{password}}, Variant{bits},
                          Variant{String{"of the night shift"}}});
    }
    std::string_view set_bits(TestClient& client, const char* name, std::uint32_t bits)
    {
        return call_user(client, id::UserManagement_ModifyUser,
                         {Variant{String{name}}, Variant{false}, Variant{String{}}, Variant{true},
                          Variant{bits}, Variant{false}, Variant{String{}}});
    }
    std::string_view change_password(TestClient& client, const char* from, const char* to)
    {
        return call_user(client, id::UserManagement_ChangePassword,
                         {Variant{String{from}}, Variant{String{to}}});
    }
    std::string_view remove(TestClient& client, const char* name)
    {
        return call_user(client, id::UserManagement_RemoveUser, {Variant{String{name}}});
    }
};

constexpr const char* patience = "patience is all";

/// A text that is nowhere in memory but where show() puts it: letters from `first` on in an order
/// of their own, as alphabets may lie anywhere.
class Hidden {
public:
    static constexpr std::size_t size = 24;
    static constexpr char mask = 0x5A;

    explicit Hidden(char first)
    {
        for (std::size_t i = 0; i < size; ++i) {
            hidden_[i] = static_cast<char>((first + static_cast<char>(i * 7 % 26)) ^ mask);
        }
    }
    String show()
    {
        for (std::size_t i = 0; i < size; ++i) {
            shown_[i] = static_cast<char>(hidden_[i] ^ mask);
        }
        return String::borrow({shown_.data(), size});
    }
    void hide() { crypto::cleanse(std::as_writable_bytes(std::span{shown_})); }
    /// How many copies there are in the heap.
    [[nodiscard]] std::size_t copies() const
    {
        std::size_t found = 0;
        std::ifstream maps{"/proc/self/maps"};
        for (std::string line; std::getline(maps, line);) {
            if (line.find("[heap]") != std::string::npos) {
                const auto dash = line.find('-');
                found += copies_in(std::stoull(line, nullptr, 16),
                                   std::stoull(line.substr(dash + 1), nullptr, 16));
            }
        }
        return found;
    }

private:
    [[nodiscard]] std::size_t copies_in(std::uintptr_t begin, std::uintptr_t end) const
    {
        const auto* const from = reinterpret_cast<const char*>(begin);
        const std::span memory{from, end - begin};
        std::size_t found = 0;
        auto place = memory.begin();
        const auto is_same = [](char there, char hidden) { return (there ^ mask) == hidden; };
        while ((place = std::search(place, memory.end(), hidden_.begin(), hidden_.end(),
                                    is_same)) != memory.end()) {
            ++found;
            ++place;
        }
        return found;
    }

    std::array<char, size> hidden_{};
    std::array<char, size> shown_{};
};

} // namespace

TEST_CASE("user management: passwords do not stay in memory")
{
    ManualWorker manual;
    Users users{GENERATE(false, true) ? &manual : nullptr};
    Hidden old_password{'A'};
    Hidden new_password{'a'};
    auto admin = users.log_in();
    const auto call_hidden = [&](std::uint32_t method, std::vector<Variant> inputs) {
        const auto sent = admin.send_bytes([&](binary::Writer& writer) {
            CallRequest request;
            request.request_header.authentication_token = admin.authentication_token;
            request.methods_to_call.resize(1);
            request.methods_to_call[0].object_id = NodeId{0, id::UserManagement};
            request.methods_to_call[0].method_id = NodeId{0, method};
            request.methods_to_call[0].input_arguments = Array<Variant>{inputs};
            encode(writer, NodeId{0, CallRequest::binary_encoding_id});
            encode(writer, request);
        });
        manual.work();
        users.complete();
        return admin.take<CallResponse>(sent).value().results[0].status_code;
    };
    SECTION("a wrong old one")
    {
        const auto status =
            call_hidden(id::UserManagement_ChangePassword,
                        {Variant{old_password.show()}, Variant{new_password.show()}});
        CHECK(status == status::Bad_IdentityTokenInvalid);
    }
    SECTION("that of a new user")
    {
        const auto status =
            call_hidden(id::UserManagement_AddUser, {Variant{"pat"}, Variant{new_password.show()},
                                                     Variant{std::uint32_t{0}}, Variant{""}});
        CHECK(status == status::Good);
    }
    SECTION("one that another takes the place of")
    {
        REQUIRE(users.user_list.add({"pat", {}, 0, {}, {}}, patience, users.random));
        const auto status =
            call_hidden(id::UserManagement_ModifyUser,
                        {Variant{"pat"}, Variant{true}, Variant{new_password.show()},
                         Variant{false}, Variant{std::uint32_t{0}}, Variant{false}, Variant{""}});
        CHECK(status == status::Good);
    }
    old_password.hide();
    new_password.hide();
    CHECK(old_password.copies() == 0);
    CHECK(new_password.copies() == 0);
}

TEST_CASE_METHOD(Users, "user management: users come, change and go",
                 "[unit:Security User Management Server]")
{
    auto admin = log_in();
    CHECK(add(admin, "pat", "short") == "Bad_OutOfRange");
    CHECK(add(admin, "pat", patience) == "Good");
    CHECK(add(admin, "pat", patience) == "Bad_AlreadyExists");
    auto pat = log_in("pat", patience);

    const DataValue users = read(admin, id::UserManagement_Users);
    REQUIRE(users.value.array_size() == 2);
    const auto second = (*users.value.array_if<ExtensionObject>())[1];
    const auto* const facts = second.get_if<UserManagementDataType>();
    CHECK((facts == nullptr || facts->user_name.view() == "pat"));
    CHECK(read(pat, id::UserManagement_Users).status.is_bad());
    CHECK(read(admin, id::UserManagement_PasswordOptions).value.value_or<std::uint32_t>(0) == 31);
    CHECK(read(admin, id::UserManagement_PasswordLength).status.is_good());
    CHECK(read(admin, id::UserManagement_PasswordRestrictions).status.is_good());

    CHECK(set_bits(admin, "pat", administration::user_bit::no_delete) == "Good");
    CHECK(remove(admin, "pat") == "Bad_NotSupported");
    CHECK(set_bits(admin, "pat", 0) == "Good");
    CHECK(set_bits(admin, "nobody", 0) == "Bad_NotFound");
    CHECK(remove(admin, "pat") == "Good");
    CHECK(user_list.users().size() == 1);
    // The session is over, and there is no such user any more.
    CHECK(pat.status_of<ReadResponse>(ReadRequest{}).is_bad());
    auto again = connect();
    REQUIRE(again.create_session());
    CHECK(again.activate(again.user("pat", patience)).is_bad());
}

TEST_CASE_METHOD(Users, "user management: accounts of the configuration are shown and not changed",
                 "[unit:Security User Management Server]")
{
    const char* const secret = "a word of the file";
    REQUIRE(passwords.set("op", *crypto::hash_password(secret, random),
                          {0xFF, {"Operator", "SecurityAdmin"}}));
    configured.replace({{.name = "op", .roles = {"Operator", "SecurityAdmin"}}});
    auto admin = log_in();
    const DataValue users = read(admin, id::UserManagement_Users);
    REQUIRE(users.value.array_size() == 2);
    const auto second = (*users.value.array_if<ExtensionObject>())[1];
    const auto* const facts = second.get_if<UserManagementDataType>();
    REQUIRE(facts != nullptr);
    CHECK(facts->user_name.view() == "op");
    CHECK(facts->description.view() == "of the configuration file");
    CHECK(static_cast<std::uint32_t>(facts->user_configuration) == 5); // NoDelete, NoChangeByUser

    CHECK(add(admin, "op", patience) == "Bad_AlreadyExists");
    CHECK(set_bits(admin, "op", administration::user_bit::disabled) == "Bad_NotSupported");
    CHECK(remove(admin, "op") == "Bad_NotSupported");
    auto op = log_in("op", secret);
    CHECK(change_password(op, "guessed", patience) == "Bad_IdentityTokenInvalid");
    CHECK(change_password(op, secret, patience) == "Bad_NotSupported");
    CHECK(log.text.find("Change the user in the configuration that defines it") !=
          std::string::npos);

    constexpr std::uint32_t operators = 16225;       // Identities of Operator
    constexpr std::uint32_t remove_identity = 15686; // of Operator
    const DataValue identities = read(admin, operators);
    REQUIRE(identities.value.array_size() == 1);
    const auto first = (*identities.value.array_if<ExtensionObject>())[0];
    const auto* const rule = first.get_if<IdentityMappingRuleType>();
    REQUIRE(rule != nullptr);
    CHECK(*rule == IdentityMappingRuleType{IdentityCriteriaType::UserName, "op"});
    CHECK(name(call(admin, NodeId{0, id::WellKnownRole_Operator}, NodeId{0, remove_identity},
                    {Variant{first}})
                   .status_code) == "Bad_RequestNotAllowed");
    CHECK(roles.find("Operator")->identities.empty());
}

TEST_CASE_METHOD(Users, "user management: who waits for an administrator is told of changes")
{
    const NodeId in_setup{0, 19309};
    auto admin = log_in();
    ReadRequest request;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = in_setup;
    request.nodes_to_read[0].attribute_id = 13;
    const auto is_in_setup = [&] {
        const auto response = admin.call<ReadResponse>(request);
        REQUIRE(response);
        return response->results[0].value == Variant{true};
    };
    CHECK(is_in_setup());
    CHECK(add(admin, "pat", "short") == "Bad_OutOfRange");
    CHECK(changes == 0);
    CHECK(add(admin, "pat", patience) == "Good");
    CHECK(changes == 1);
    CHECK_FALSE(is_in_setup());
}

TEST_CASE_METHOD(Users, "user management: of two who make the first administrator one is late")
{
    auto first = log_in();
    auto second = log_in();
    REQUIRE(add(first, "pat", patience) == "Good");
    suspended = "admin";
    CHECK(add(second, "sam", patience) == "Bad_UserAccessDenied");
    CHECK(call(second, NodeId{0, id::WellKnownRole_Operator}, NodeId{0, 15684}, // AddIdentity
               {Variant{ExtensionObject::from(
                   IdentityMappingRuleType{IdentityCriteriaType::UserName, "pat"})}})
              .status_code == status::Bad_UserAccessDenied);
    CHECK(user_list.users().size() == 2);
}

TEST_CASE_METHOD(Users, "user management: a disabled user's sessions end")
{
    auto admin = log_in();
    REQUIRE(add(admin, "pat", patience) == "Good");
    auto pat = log_in("pat", patience);
    CHECK(set_bits(admin, "pat", administration::user_bit::disabled) == "Good");
    CHECK(pat.status_of<ReadResponse>(ReadRequest{}).is_bad());
    CHECK(log.text.find("patience") == std::string::npos);
}

TEST_CASE_METHOD(Users, "user management: nobody shuts himself out")
{
    auto admin = log_in();
    CHECK(set_bits(admin, "admin", administration::user_bit::disabled) ==
          "Bad_InvalidSelfReference");
    CHECK(remove(admin, "admin") == "Bad_InvalidSelfReference");
    REQUIRE(add(admin, "pat", patience) == "Good");
    REQUIRE(roles.add_identity("SecurityAdmin", {IdentityCriteriaType::UserName, "pat"}));
    auto pat = log_in("pat", patience);
    // The list alone says who is an administrator here.
    CHECK(remove(pat, "admin") == "Bad_RequestNotAllowed");
}

TEST_CASE_METHOD(Users, "user management: who must change the password can do that alone")
{
    auto admin = log_in();
    REQUIRE(add(admin, "pat", patience, administration::user_bit::must_change_password) == "Good");
    auto pat = connect();
    REQUIRE(pat.create_session());
    CHECK(pat.activate(pat.user("pat", patience)) == status::Good_PasswordChangeRequired);
    CHECK(add(pat, "sam", patience).starts_with("Bad_"));
    CHECK(change_password(pat, "not the one", "something else") == "Bad_IdentityTokenInvalid");
    CHECK(change_password(pat, patience, patience) == "Bad_AlreadyExists");
    CHECK(change_password(pat, patience, "something else") == "Good");
    CHECK(pat.activate(pat.user("pat", "something else")) == status::Good);
}

TEST_CASE_METHOD(Users, "user management: over encrypted channels and for SecurityAdmin only")
{
    auto admin = log_in();
    REQUIRE(add(admin, "pat", patience) == "Good");
    auto pat = log_in("pat", patience);
    CHECK(add(pat, "sam", patience) == "Bad_NodeIdUnknown"); // may not see it
    auto signing = log_in("admin", "admin-secret!", MessageSecurityMode::Sign);
    CHECK(add(signing, "sam", patience) == "Bad_SecurityModeInsufficient");
    CHECK(change_password(signing, "admin-secret!", patience) == "Bad_SecurityModeInsufficient");
}

TEST_CASE("user management: hashes are made by the worker")
{
    ManualWorker worker;
    Users users{&worker};
    auto admin = users.log_in();
    CallRequest request;
    request.methods_to_call.resize(1);
    request.methods_to_call[0].object_id = NodeId{0, id::UserManagement};
    request.methods_to_call[0].method_id = NodeId{0, id::UserManagement_AddUser};
    request.methods_to_call[0].input_arguments = {Variant{String{"pat"}}, Variant{String{patience}},
                                                  Variant{std::uint32_t{0}}, Variant{String{}}};
    const auto sent = admin.send(request);
    CHECK(users.user_list.users().size() == 1);
    worker.work();
    users.complete();
    const auto response = admin.take<CallResponse>(sent);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Good);
    CHECK(users.user_list.users().size() == 2);
    worker.has_room = false;
    CHECK(users.add(admin, "sam", patience) == "Bad_TooManyOperations");
}

TEST_CASE_METHOD(Users, "user management: an old password cannot be guessed at")
{
    auto admin = log_in();
    REQUIRE(add(admin, "pat", patience) == "Good");
    auto pat = log_in("pat", patience);
    const std::size_t most = server.config().limits.max_login_failures;
    for (std::size_t i = 0; i < most; ++i) {
        CHECK(change_password(pat, "a guess that is wrong", "my own choice") ==
              "Bad_IdentityTokenInvalid");
    }
    CHECK(change_password(pat, patience, "my own choice") == "Bad_UserAccessDenied");
    CHECK(user_list.find("pat")); // and is not locked out elsewhere
    now += server.config().limits.login_lock;
    server.handle_deadline(now);
    pat = log_in("pat", patience);
    CHECK(change_password(pat, patience, "my own choice") == "Good");
}

TEST_CASE("user management: changes are made one by one, and users take turns")
{
    ManualWorker worker;
    Users users{&worker};
    REQUIRE(users.user_list.add({"chief", {}, 0, {}, {"SecurityAdmin"}}, patience, users.random));
    auto admin = users.log_in();
    auto chief = users.log_in("chief", patience);
    const auto request = [](const std::vector<const char*>& names) {
        CallRequest all;
        for (const char* name : names) {
            CallMethodRequest each;
            each.object_id = NodeId{0, id::UserManagement};
            each.method_id = NodeId{0, id::UserManagement_AddUser};
            each.input_arguments = {Variant{String{name}}, Variant{String{patience}},
                                    Variant{std::uint32_t{0}}, Variant{String{}}};
            all.methods_to_call.push_back(each);
        }
        return all;
    };
    const auto there = [&](const char* name) { return users.user_list.find(name).has_value(); };
    const auto many = admin.send(request({"a", "b", "c"}));
    const auto one = chief.send(request({"z"}));
    CHECK(worker.jobs.size() == 1); // whoever logs in waits for one of them at most
    const auto next = [&] {
        worker.work();
        users.complete();
    };
    next();
    CHECK(there("a"));
    next();
    CHECK((there("z") && !there("b")));
    CHECK(chief.take<CallResponse>(one));
    next();
    next();
    CHECK((there("b") && there("c")));
    CHECK(admin.take<CallResponse>(many));
    CHECK(worker.jobs.empty());
}

TEST_CASE("user management: many Calls of one user wait for the Call of another")
{
    ManualWorker worker;
    Users users{&worker};
    REQUIRE(users.user_list.add({"chief", {}, 0, {}, {"SecurityAdmin"}}, patience, users.random));
    auto admin = users.log_in();
    auto chief = users.log_in("chief", patience);
    const auto add_later = [](TestClient& client, const char* name) {
        CallRequest request;
        CallMethodRequest& each = request.methods_to_call.emplace_back();
        each.object_id = NodeId{0, id::UserManagement};
        each.method_id = NodeId{0, id::UserManagement_AddUser};
        each.input_arguments = {Variant{String{name}}, Variant{String{patience}},
                                Variant{std::uint32_t{0}}, Variant{String{}}};
        client.send(request);
    };
    for (const char* name : {"a", "b", "c"}) {
        add_later(admin, name);
    }
    add_later(chief, "z");
    const auto there = [&](const char* name) { return users.user_list.find(name).has_value(); };
    for (int i = 0; i < 2; ++i) { // the one that was begun, and that of the other user
        worker.work();
        users.complete();
    }
    CHECK((there("a") && there("z")));
    CHECK_FALSE((there("b") || there("c")));
    while (!worker.jobs.empty()) {
        worker.work();
        users.complete();
    }
    CHECK((there("b") && there("c")));
}

TEST_CASE("user management: the jobs of some users leave places for those of others")
{
    ManualWorker worker;
    Users users{&worker};
    CallMethodRequest change;
    change.object_id = NodeId{0, id::UserManagement};
    change.method_id = NodeId{0, id::UserManagement_ChangePassword};
    change.input_arguments = {Variant{String{"a"}}, Variant{String{"b"}}};
    CallRequest many;
    many.methods_to_call.resize(64);
    std::fill(many.methods_to_call.begin(), many.methods_to_call.end(), change);
    std::vector<TestClient> greedy;
    for (const char* name : {"a", "b", "c", "d", "e"}) { // the places of four
        REQUIRE(users.user_list.add({name, {}, 0, {}, {"Observer"}}, patience, users.random));
        greedy.push_back(users.log_in(name, patience));
        greedy.back().send(many);
        users.complete();
    }
    auto admin = users.log_in();
    CallRequest request;
    request.methods_to_call.resize(1);
    request.methods_to_call[0].object_id = NodeId{0, id::UserManagement};
    request.methods_to_call[0].method_id = NodeId{0, id::UserManagement_RemoveUser};
    request.methods_to_call[0].input_arguments = {Variant{String{"e"}}};
    const auto sent = admin.send(request);
    CHECK_FALSE(admin.take<CallResponse>(sent)); // it waits
    worker.work();
    users.complete();
    CHECK(worker.jobs.size() == 1);
    while (!worker.jobs.empty()) { // it ends before the administration
        worker.work();
        users.complete();
    }
}

TEST_CASE("user management: what the client gave up is not done")
{
    ManualWorker worker;
    Users users{&worker};
    REQUIRE(users.user_list.add({"chief", {}, 0, {}, {"SecurityAdmin"}}, patience, users.random));
    auto admin = users.log_in();
    auto chief = users.log_in("chief", patience);
    admin.timeout_hint = chief.timeout_hint = 1'000;
    const auto add_later = [&](TestClient& client, const char* name) {
        CallRequest request;
        request.methods_to_call.resize(1);
        request.methods_to_call[0].object_id = NodeId{0, id::UserManagement};
        request.methods_to_call[0].method_id = NodeId{0, id::UserManagement_AddUser};
        request.methods_to_call[0].input_arguments = {Variant{String{name}},
                                                      Variant{String{patience}},
                                                      Variant{std::uint32_t{0}}, Variant{String{}}};
        return client.send(request);
    };
    const auto is_there = [&](const char* name) { return users.user_list.find(name).has_value(); };

    const auto with_worker = add_later(admin, "pat");
    const auto waiting = add_later(chief, "sam");
    users.advance(std::chrono::seconds{2});
    admin.connection.handle_deadline(users.now);
    chief.connection.handle_deadline(users.now);
    CHECK(admin.take<CallResponse>(with_worker).error() == status::Bad_Timeout);
    CHECK(chief.take<CallResponse>(waiting).error() == status::Bad_Timeout);
    while (!worker.jobs.empty()) {
        worker.work();
        users.complete();
    }
    CHECK_FALSE(is_there("pat"));
    CHECK_FALSE(is_there("sam"));

    const auto in_time = add_later(admin, "pat");
    worker.work();
    users.complete();
    CHECK(admin.take<CallResponse>(in_time));
    CHECK(is_there("pat"));
    const auto hashed = add_later(admin, "sam");
    worker.work();
    users.advance(std::chrono::seconds{2});
    admin.connection.handle_deadline(users.now);
    CHECK(admin.take<CallResponse>(hashed).error() == status::Bad_Timeout);
    users.complete();
    CHECK_FALSE(is_there("sam"));
}

TEST_CASE("user management: twenty users who change passwords do not keep logins waiting")
{
    ManualWorker worker;
    Users users{&worker};
    users.passwords.set_worker(&worker);
    REQUIRE(users.user_list.add({"chief", {}, 0, {}, {"SecurityAdmin"}}, patience, users.random));
    std::vector<TestClient> changing;
    std::vector<std::uint32_t> changes;
    const auto work_all = [&] {
        while (!worker.jobs.empty()) {
            worker.work();
            users.complete();
            users.server.handle_completions(users.now);
        }
    };
    const auto begin_login = [&](TestClient& client, const char* name) {
        REQUIRE(client.create_session());
        return client.send_activate(client.user(name, patience));
    };
    for (int i = 0; i < 20; ++i) {
        const std::string name = "user" + std::to_string(i);
        REQUIRE(users.user_list.add({name, {}, 0, {}, {"Operator"}}, patience, users.random));
        changing.push_back(users.connect());
        const auto sent = begin_login(changing.back(), name.c_str());
        work_all();
        REQUIRE(changing.back().take_activate(sent) == status::Good);
    }
    for (TestClient& client : changing) {
        CallRequest request;
        for (const auto& [from, to] :
             {std::pair{patience, "something else"}, std::pair{"something else", patience}}) {
            CallMethodRequest each;
            each.object_id = NodeId{0, id::UserManagement};
            each.method_id = NodeId{0, id::UserManagement_ChangePassword};
            each.input_arguments = {Variant{String{from}}, Variant{String{to}}};
            request.methods_to_call.push_back(each);
        }
        changes.push_back(client.send(request));
    }
    CHECK(worker.jobs.size() == 1);
    // Each login is the second job at most that the worker does from then on.
    for (int i = 0; i < 5; ++i) {
        auto client = users.connect();
        const auto sent = begin_login(client, "chief");
        REQUIRE(worker.jobs.size() <= 2);
        worker.work();
        users.server.handle_completions(users.now);
        users.complete();
        CHECK(client.take_activate(sent) == status::Good);
    }
    work_all();
    for (std::size_t i = 0; i < changing.size(); ++i) {
        const auto response = changing[i].take<CallResponse>(changes[i]);
        REQUIRE(response);
        for (const CallMethodResult& result : response->results) {
            CHECK(name(result.status_code) == "Good");
        }
    }
}

TEST_CASE("user management: a job that is lost does not stop the others")
{
    ManualWorker worker;
    Users users{&worker};
    REQUIRE(users.user_list.add({"chief", {}, 0, {}, {"SecurityAdmin"}}, patience, users.random));
    auto admin = users.log_in();
    auto chief = users.log_in("chief", patience);
    CallRequest request;
    request.methods_to_call.resize(1);
    request.methods_to_call[0].object_id = NodeId{0, id::UserManagement};
    request.methods_to_call[0].method_id = NodeId{0, id::UserManagement_AddUser};
    request.methods_to_call[0].input_arguments = {Variant{String{"pat"}}, Variant{String{patience}},
                                                  Variant{std::uint32_t{0}}, Variant{String{}}};
    const auto lost = admin.send(request);
    worker.jobs.clear(); // as an exception in it would end it
    users.complete();
    const auto response = admin.take<CallResponse>(lost);
    REQUIRE(response);
    CHECK(name(response->results[0].status_code) == "Bad_InternalError");
    chief.send(request);
    REQUIRE(worker.jobs.size() == 1);
    worker.work();
    users.complete();
    CHECK(users.user_list.find("pat"));
}

TEST_CASE("user management: what waits is not done for a session that is over")
{
    ManualWorker worker;
    Users users{&worker};
    auto admin = users.log_in();
    auto other = users.log_in();
    CallRequest request;
    request.methods_to_call.resize(1);
    request.methods_to_call[0].object_id = NodeId{0, id::UserManagement};
    request.methods_to_call[0].method_id = NodeId{0, id::UserManagement_AddUser};
    request.methods_to_call[0].input_arguments = {Variant{String{"pat"}}, Variant{String{patience}},
                                                  Variant{std::uint32_t{0}}, Variant{String{}}};
    admin.send(request);
    request.methods_to_call[0].input_arguments[0] = Variant{String{"sam"}};
    other.send(request);
    other.close_session();
    while (!worker.jobs.empty()) {
        worker.work();
        users.complete();
    }
    CHECK(users.user_list.find("pat"));
    CHECK_FALSE(users.user_list.find("sam"));
}

TEST_CASE_METHOD(Users, "user management: a medium that fails changes nothing")
{
    auto admin = log_in();
    storage.set_protected(true);
    CHECK(add(admin, "pat", patience) == "Bad_ResourceUnavailable");
    CHECK(user_list.users().size() == 1);
}

TEST_CASE_METHOD(Users, "user management: what is not to be modified stays (Part 18, 5.2.6)")
{
    auto admin = log_in();
    REQUIRE(add(admin, "pat", patience, administration::user_bit::no_delete) == "Good");
    const auto modify = [&](const char* password, const char* description) {
        return call_user(admin, id::UserManagement_ModifyUser,
                         {Variant{String{"pat"}}, Variant{password != nullptr},
                          Variant{String{password != nullptr ? password : "not looked at"}},
                          Variant{false}, Variant{administration::user_bit::disabled},
                          Variant{description != nullptr},
                          Variant{String{description != nullptr ? description : "nor this"}}});
    };
    CHECK(modify(nullptr, nullptr) == "Good");
    CHECK(user_list.users()[1].description == "of the night shift");
    CHECK(modify(nullptr, "of the day shift") == "Good");
    CHECK(user_list.users()[1].description == "of the day shift");
    CHECK_FALSE(log_in("pat", patience).is_closed());
    CHECK(modify("short", nullptr) == "Bad_OutOfRange");
    CHECK(modify("something else", nullptr) == "Good");
    CHECK(user_list.users()[1].configuration == administration::user_bit::no_delete);
    CHECK_FALSE(log_in("pat", "something else").is_closed());
    auto old = connect();
    REQUIRE(old.create_session());
    CHECK(old.activate(old.user("pat", patience)).is_bad());
}

TEST_CASE_METHOD(Users, "users, passwords and roles stay where the program says that they may not "
                        "change")
{
    TestClient admin = log_in();
    CHECK(add(admin, "pat", patience) == "Good");
    hold = Problem{status::Bad_InvalidState, "users and roles", "cannot change in RUN"};
    CHECK(add(admin, "kim", patience) == "Bad_InvalidState");
    CHECK(set_bits(admin, "pat", 1) == "Bad_InvalidState");
    CHECK(remove(admin, "pat") == "Bad_InvalidState");
    CHECK(change_password(admin, "admin-secret!", patience) == "Bad_InvalidState");
    const auto call_role = [&](NodeId object, NodeId method, std::vector<Variant> inputs) {
        return std::string{name(call(admin, object, method, std::move(inputs)).status_code)};
    };
    const NodeId set{0, id::Server_ServerCapabilities_RoleSet};
    CHECK(call_role(set, NodeId{0, id::Server_ServerCapabilities_RoleSet_AddRole},
                    {Variant{"Painters"}, Variant{String{}}}) == "Bad_InvalidState");
    CHECK(call_role(set, NodeId{0, id::Server_ServerCapabilities_RoleSet_RemoveRole},
                    {Variant{NodeId{0, id::WellKnownRole_Observer}}}) == "Bad_InvalidState");
    CHECK(log.text.find("cannot change in RUN") != std::string::npos);
    CHECK(user_list.users().size() == 2);
    hold.reset();
    CHECK(remove(admin, "pat") == "Good");
}

} // namespace user_management_test
