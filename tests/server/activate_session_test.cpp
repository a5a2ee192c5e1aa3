#include <catch2/catch.hpp>

#include "support/job_list.hpp"
#include "user_fixture.hpp"

namespace activate_session_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Of a second application.
const channel::ApplicationIdentity& other_client()
{
    static const auto identity = make_identity("client2");
    return identity;
}

enum class Kind : std::uint8_t { Anonymous, UserName, Certificate, Issued };

/// A right token of that kind for the client's last nonce; of another person if `is_other`.
StatusCode activate_as(UserFixture& fixture, TestClient& client, Kind kind, bool is_other)
{
    switch (kind) {
    case Kind::Anonymous:
        return is_other ? fixture.activate(client, client.user("operator", "operator-secret"))
                        : fixture.activate(client, TestClient::anonymous());
    case Kind::UserName:
        return is_other ? fixture.activate(client, client.user("engineer", "engineer-secret"))
                        : fixture.activate(client, client.user("operator", "operator-secret"));
    case Kind::Certificate:
        return is_other ? fixture.activate(client, client.user("CN=maria", "CN=maria-secret"))
                        : fixture.activate(client, certificate_token(), user_signature(client));
    case Kind::Issued:
        return is_other ? fixture.activate(client, client.user("maria", "maria-secret"))
                        : fixture.activate(client, issued_token(client, jwt()));
    }
    return status::Bad_InternalError;
}

server::ServerConfig every_user_everywhere()
{
    auto config = UserFixture::all_kinds();
    for (auto& endpoint : config.endpoints) {
        endpoint.allows_anonymous = true;
    }
    return config;
}

} // namespace

TEST_CASE("a session moves to a new channel with its client, user, security and nonce only")
{
    UserFixture fixture{every_user_everywhere()};
    const auto kind = GENERATE(Kind::Anonymous, Kind::UserName, Kind::Certificate, Kind::Issued);
    const bool is_other_client = GENERATE(false, true);
    const bool is_other_user = GENERATE(false, true);
    const bool is_weaker = GENERATE(false, true);
    const bool is_old_nonce = GENERATE(false, true);
    CAPTURE(static_cast<int>(kind), is_other_client, is_other_user, is_weaker, is_old_nonce);

    auto old = fixture.connect(encrypt);
    REQUIRE(old.create_session());
    const ByteString old_nonce = old.server_nonce;
    REQUIRE(activate_as(fixture, old, kind, false) == status::Good);
    auto client = fixture.connect(is_weaker ? sign : encrypt,
                                  is_other_client ? other_client() : client_identity());
    client.adopt(old);
    if (is_old_nonce) {
        client.server_nonce = old_nonce;
    }
    const StatusCode expected = is_other_client || is_weaker ? status::Bad_SecurityChecksFailed
                                : is_old_nonce  ? status::Bad_ApplicationSignatureInvalid
                                : is_other_user ? status::Bad_IdentityChangeNotSupported
                                                : status::Good;
    CHECK(activate_as(fixture, client, kind, is_other_user) == expected);
    CHECK(fixture.refusals() == (expected.is_good() ? 0 : 1));
    CHECK(use(old) == (expected.is_good() ? status::Bad_SecureChannelIdInvalid : status::Good));
    if (expected.is_good()) {
        CHECK(use(client) == status::Good);
    }
}

TEST_CASE("the first activation comes over the session's own channel, with every token")
{
    UserFixture fixture{every_user_everywhere()};
    const auto kind = GENERATE(Kind::Anonymous, Kind::UserName, Kind::Certificate, Kind::Issued);
    auto owner = fixture.connect(encrypt);
    REQUIRE(owner.create_session());
    auto thief = fixture.connect(encrypt);
    thief.adopt(owner);
    CHECK(activate_as(fixture, thief, kind, false) == status::Bad_SecureChannelIdInvalid);
    CHECK(fixture.users.asked == 0);
    CHECK(activate_as(fixture, owner, kind, false) == status::Good);
}

TEST_CASE("a nonce is good for one activation")
{
    UserFixture fixture;
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    ActivateSessionRequest request;
    request.client_signature = client.signature();
    request.user_identity_token = client.user("operator", "operator-secret");
    CHECK(client.status_of<ActivateSessionResponse>(request) == status::Good);
    CHECK(client.status_of<ActivateSessionResponse>(request) ==
          status::Bad_ApplicationSignatureInvalid);
}

TEST_CASE("the tokens that cannot be guessed are counted all the same")
{
    UserFixture fixture;
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    fixture.validator.list.trusted.clear();
    ActivateSessionRequest request;
    request.client_signature = client.signature();
    request.user_identity_token = certificate_token();
    request.user_token_signature = user_signature(client);
    for (const auto delay : {0ms, 250ms, 500ms, 1000ms, 2000ms}) {
        const auto sent = client.send(request);
        fixture.advance(delay, client);
        REQUIRE(client.take_activate(sent) == status::Bad_IdentityTokenRejected);
    }
    fixture.validator.list.trusted = {user_certificate().certificate};
    const auto locked = client.send(request);
    CHECK(client.take_activate(locked) == status::Bad_WouldBlock);
    fixture.advance(4s, client);
    CHECK(client.take_activate(locked) == status::Bad_UserAccessDenied);
    CHECK(fixture.log.text.find("login lock-out") != std::string::npos);
    // Its users with passwords are not concerned.
    CHECK(fixture.activate(client, client.user("operator", "operator-secret")) == status::Good);
}

TEST_CASE("wrong kinds of token are no guesses")
{
    UserFixture fixture;
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    for (int i = 0; i < 30; ++i) {
        CHECK(fixture.activate(client, TestClient::anonymous()) ==
              status::Bad_IdentityTokenRejected);
    }
    CHECK(fixture.activate(client, client.user("operator", "operator-secret")) == status::Good);
}

namespace {

/// A user name at which hundreds guess, without certificates.
void attack(UserFixture& fixture, const std::string& name, int sources)
{
    for (int i = 0; i < sources; ++i) {
        auto client = fixture.connect({}, client_identity(), "198.51.100." + std::to_string(i));
        REQUIRE(client.create_session());
        const auto guess = client.send_activate(client.user(name, "guess"));
        fixture.advance(4s, client);
        REQUIRE(client.take_activate(guess) == status::Bad_UserAccessDenied);
    }
}

} // namespace

TEST_CASE("guessing elsewhere delays the right user at a new place, and never at a known one")
{
    UserFixture fixture;
    auto known = fixture.log_in(encrypt);
    attack(fixture, "operator", 12);
    fixture.users.asked = 0;

    CHECK(fixture.activate(known, known.user("operator", "operator-secret")) == status::Good);

    auto request_from = [](const TestClient& client) {
        ActivateSessionRequest request;
        request.client_signature = client.signature();
        request.user_identity_token = client.user("operator", "operator-secret");
        return request;
    };
    auto fresh = fixture.connect(encrypt, other_client(), "192.0.2.99");
    auto create = fresh.create_request();
    create.client_description.application_uri = "urn:busbar:test:client2";
    REQUIRE(fresh.create_session(create));
    const auto waiting = fresh.send(request_from(fresh));
    CHECK(fresh.take_activate(waiting) == status::Bad_WouldBlock);
    CHECK(fixture.users.asked == 1); // it is not even looked at
    SECTION("then it is let in")
    {
        fixture.advance(4s, fresh);
        CHECK(fresh.take_activate(waiting) == status::Good);
        CHECK(fixture.users.asked == 2);
    }
    SECTION("what was sent twice is let in once")
    {
        const auto again = fresh.send(request_from(fresh));
        fixture.advance(4s, fresh);
        const StatusCode first = fresh.take_activate(waiting);
        const StatusCode second = fresh.take_activate(again);
        CHECK(first == status::Good);
        CHECK(second == status::Bad_ApplicationSignatureInvalid);
    }
    SECTION("the session ends meanwhile")
    {
        REQUIRE(fresh.close_session() == status::Good);
        fixture.advance(4s, fresh);
        CHECK(fresh.take_activate(waiting) == status::Bad_SessionClosed);
    }
}

namespace {

class CountingWaker final : public server::Waker {
public:
    void wake() override { ++count; }

    int count{0};
};

/// A server whose passwords a worker checks.
struct Working {
    Working() { fixture.users.used_worker = &worker; }

    /// Sends what is a right login but for the password.
    std::uint32_t send(TestClient& client, std::string_view password)
    {
        return client.send_activate(client.user("operator", password));
    }
    void work()
    {
        while (worker.work_once()) {
        }
    }
    void finish(TestClient& client)
    {
        work();
        fixture.server.handle_completions(fixture.now);
        client.run();
    }

    CountingWaker waker;
    JobList worker;
    ServerFixture fixture{waker};
};

} // namespace

TEST_CASE_METHOD(Working, "passwords are checked by a worker while others are served")
{
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    const auto sent = send(client, "operator-secret");
    CHECK(client.take_activate(sent) == status::Bad_WouldBlock);
    auto other = fixture.connect();
    REQUIRE(other.open_session() == status::Good); // anonymous: needs no check
    CHECK(use(other) == status::Good);

    SECTION("right")
    {
        finish(client);
        CHECK(waker.count == 1);
        CHECK(client.take_activate(sent) == status::Good);
        CHECK(use(client) == status::Good);
    }
    SECTION("wrong, for the second time: the answer waits, and who drives the connection learns it")
    {
        finish(client);
        REQUIRE(client.take_activate(sent) == status::Good);
        for (const Duration delay : {Duration{0}, Duration{250ms}}) {
            const auto guess = send(client, "guess");
            while (fixture.server.next_changed()) {
            }
            work();
            fixture.server.handle_completions(fixture.now);
            CHECK(fixture.server.next_changed() == client.connection.id());
            fixture.advance(delay, client);
            CHECK(client.take_activate(guess) == status::Bad_UserAccessDenied);
        }
    }
    SECTION("the client goes away")
    {
        client.channel.close();
        client.run();
        finish(client);
        CHECK(use(other) == status::Good);
    }
    SECTION("the session ends")
    {
        REQUIRE(client.close_session() == status::Good);
        finish(client);
        CHECK(client.take_activate(sent) == status::Bad_SessionClosed);
    }
    SECTION("the same request again: its nonce is good for one")
    {
        const auto again = send(client, "operator-secret");
        finish(client);
        CHECK(client.take_activate(sent) == status::Good);
        CHECK(client.take_activate(again) == status::Bad_ApplicationSignatureInvalid);
    }
    SECTION("the worker is full")
    {
        worker.most = 0;
        CHECK(client.take_activate(send(client, "operator-secret")) == status::Bad_ServerTooBusy);
    }
}

TEST_CASE_METHOD(Working, "what waits before a session is activated is little")
{
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    ActivateSessionRequest request;
    request.client_signature = client.signature();
    request.user_identity_token = client.user("operator", "operator-secret");
    const std::size_t most = server::ServerLimits{}.max_sessionless_message;
    request.client_software_certificates.resize(1);
    request.client_software_certificates[0].certificate_data =
        ByteString{std::vector<std::byte>(most / 2)};
    std::vector<std::uint32_t> sent;
    for (int i = 0; i < 60; ++i) {
        sent.push_back(client.send(request));
    }
    const auto refused = [&] {
        int count = 0;
        for (const std::uint32_t id : sent) {
            const auto response = client.take<ActivateSessionResponse>(id);
            count += !response && response.error() == status::Bad_TooManyOperations ? 1 : 0;
        }
        return count;
    }();
    CHECK(refused >= 28); // 16 of the largest that may be sent, so 32 of these
    CHECK(refused < 45);
    finish(client);
    // From now on it has what a session has.
    REQUIRE(client.is_closed() == false);
    CHECK(use(client) == status::Good);
}

namespace {

/// A server whose worker takes few logins, and clients without certificates of many addresses.
struct Crowded {
    Crowded()
    {
        worker.most = 6; // as a net::WorkerThread has an end
        fixture.users.used_worker = &worker;
        for (int i = 0; i < 8; ++i) {
            strangers.push_back(connect("192.0.2." + std::to_string(60 + i)));
        }
    }
    TestClient connect(const std::string& address)
    {
        TestClient client = fixture.connect({}, client_identity(), address);
        REQUIRE(client.create_session());
        return client;
    }
    /// Each time another user, so that none is guessed at by many.
    std::uint32_t send(TestClient& client, bool is_right)
    {
        const std::string name = "user" + std::to_string(++users);
        return client.send_activate(client.user(name, is_right ? name + "-secret" : "guess"));
    }
    /// One check of those that wait.
    void work(TestClient& client)
    {
        REQUIRE(worker.work_once());
        fixture.server.handle_completions(fixture.now);
        client.run();
    }

    CountingWaker waker;
    JobList worker;
    ServerFixture fixture{waker};
    std::deque<TestClient> strangers;
    int users{0};
};

} // namespace

TEST_CASE_METHOD(Crowded, "who has logged in before does not wait behind strangers")
{
    auto good = connect("192.0.2.1");
    const auto first = send(good, true);
    work(good);
    REQUIRE(good.take_activate(first) == status::Good);
    std::vector<std::uint32_t> sent;
    for (TestClient& stranger : strangers) {
        sent.push_back(send(stranger, false));
    }
    CHECK(strangers[6].take_activate(sent[6]) == status::Bad_ServerTooBusy); // the newest of all
    CHECK(strangers[0].take_activate(sent[0]) == status::Bad_WouldBlock);
    const auto again = send(good, true); // in place of a stranger's
    CHECK(good.take_activate(again) == status::Bad_WouldBlock);
    CHECK(strangers[5].take_activate(sent[5]) == status::Bad_ServerTooBusy);
    work(good);
    CHECK(good.take_activate(again) == status::Good);
    CHECK(fixture.log.text.find("place for a login") != std::string::npos);
}

TEST_CASE_METHOD(Crowded, "of strangers those who ask for most are refused and wait longest")
{
    TestClient& greedy = strangers[0];
    for (int i = 0; i < 4; ++i) {
        static_cast<void>(send(greedy, false));
    }
    const auto modest = send(strangers[1], true);
    const auto second = send(strangers[2], true);
    REQUIRE(worker.jobs.size() == 6);
    const auto third = send(strangers[3], true); // in place of the greedy one's
    CHECK(strangers[3].take_activate(third) == status::Bad_WouldBlock);
    CHECK(worker.jobs.size() == 6);
    work(strangers[1]);
    CHECK(strangers[1].take_activate(modest) == status::Good);
    work(strangers[2]);
    CHECK(strangers[2].take_activate(second) == status::Good);
    work(strangers[3]);
    CHECK(strangers[3].take_activate(third) == status::Good);
}

TEST_CASE_METHOD(Crowded, "strangers are not starved by those who are known")
{
    std::deque<TestClient> known;
    for (int i = 0; i < 5; ++i) {
        known.push_back(connect("192.0.2." + std::to_string(10 + i)));
        const auto first = send(known.back(), true);
        work(known.back());
        REQUIRE(known.back().take_activate(first) == status::Good);
    }
    const auto waiting = send(strangers[0], true);
    for (TestClient& client : known) {
        static_cast<void>(send(client, true));
    }
    for (int i = 0; i < 3; ++i) {
        work(strangers[0]);
        CHECK(strangers[0].take_activate(waiting) == status::Bad_WouldBlock);
    }
    work(strangers[0]);
    CHECK(strangers[0].take_activate(waiting) == status::Good);
}

TEST_CASE_METHOD(Working, "many guesses at the same time are as many as one after the other")
{
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    std::vector<std::uint32_t> sent;
    for (int i = 0; i < 20; ++i) {
        sent.push_back(send(client, "guess"));
    }
    CHECK(worker.jobs.size() == 5);
    finish(client);
    fixture.advance(4s, client);
    for (const auto request : sent) {
        CHECK(client.take_activate(request) == status::Bad_UserAccessDenied);
    }
    CHECK(fixture.users.asked == 5);
}

TEST_CASE_METHOD(Working, "as many right logins at the same time as come are let in")
{
    // Of one client, whose certificate they all have, or of as many as there are.
    const bool is_one_client = GENERATE(true, false);
    CAPTURE(is_one_client);
    constexpr int most = 30; // the limit of a source is 20, that of a user 5
    std::vector<TestClient> clients;
    std::vector<std::uint32_t> sent;
    for (int i = 0; i < most; ++i) {
        clients.push_back(
            fixture.connect(encrypt, client_identity(), is_one_client ? "192.0.2.1" : "192.0.2.2"));
        REQUIRE(clients.back().create_session());
    }
    for (TestClient& client : clients) {
        sent.push_back(send(client, "operator-secret"));
    }
    CHECK(worker.jobs.size() == 5); // no more guesses than that, if they are
    for (int i = 0; i < most; ++i) {
        fixture.server.handle_completions(fixture.now);
        work();
    }
    fixture.server.handle_completions(fixture.now);
    for (std::size_t i = 0; i < clients.size(); ++i) {
        clients[i].run();
        CHECK(clients[i].take_activate(sent[i]) == status::Good);
    }
    CHECK(fixture.users.asked == most);
}

TEST_CASE_METHOD(Working, "a right login among guesses is looked at in its turn")
{
    auto guesser = fixture.connect(encrypt);
    REQUIRE(guesser.create_session());
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    for (int i = 0; i < 4; ++i) {
        static_cast<void>(send(guesser, "guess"));
    }
    const auto fifth = send(guesser, "operator-secret");
    const auto waiting = send(client, "operator-secret");
    REQUIRE(worker.jobs.size() == 5);
    SECTION("one of those before it is right: what was wrong is forgiven, and it is let in")
    {
        finish(guesser);
        finish(client);
        CHECK(guesser.take_activate(fifth) == status::Good);
        CHECK(client.take_activate(waiting) == status::Good);
    }
    SECTION("its session ends meanwhile")
    {
        REQUIRE(client.close_session() == status::Good);
        finish(guesser);
        finish(client);
        CHECK(client.take_activate(waiting) == status::Bad_SessionClosed);
    }
    SECTION("its client goes away meanwhile")
    {
        client.channel.close();
        client.run();
        finish(guesser);
        CHECK(guesser.take_activate(fifth) == status::Good);
        CHECK(fixture.users.asked == 5);
    }
    SECTION("those before it went away and were not looked at")
    {
        guesser.channel.close();
        guesser.run();
        finish(client);
        finish(client);
        CHECK(client.take_activate(waiting) == status::Good);
        CHECK(fixture.users.asked == 1);
    }
    SECTION("those before it were looked at, and their client did not wait for the answers")
    {
        work();
        guesser.channel.close();
        guesser.run();
        finish(client);
        finish(client);
        CHECK(client.take_activate(waiting) == status::Good);
        CHECK(fixture.users.asked == 6);
    }
}

TEST_CASE_METHOD(Working, "guesses whose answers are not awaited lock out like others")
{
    for (int i = 0; i < 5; ++i) {
        auto guesser = fixture.connect(encrypt);
        REQUIRE(guesser.create_session());
        static_cast<void>(send(guesser, "guess"));
        fixture.advance(4s, guesser); // the delay before it is looked at
        work();
        guesser.channel.close();
        guesser.run();
    }
    fixture.server.handle_completions(fixture.now);
    CHECK(fixture.users.asked == 5);
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    const auto sent = send(client, "operator-secret");
    finish(client);
    fixture.advance(4s, client);
    CHECK(client.take_activate(sent) == status::Bad_UserAccessDenied);
    CHECK(fixture.users.asked == 5);
}

TEST_CASE_METHOD(Working, "a guess whose answer is not awaited has a record all the same")
{
    auto guesser = fixture.connect(encrypt);
    REQUIRE(guesser.create_session());
    fixture.log.keeps_records = true;
    static_cast<void>(send(guesser, "guess"));
    std::string status;
    SECTION("its connection ends")
    {
        guesser.channel.close();
        guesser.run();
        status = "Bad_ConnectionClosed";
    }
    SECTION("its session is closed")
    {
        REQUIRE(guesser.close_session() == status::Good);
        status = "Bad_SessionClosed";
    }
    SECTION("it is awaited")
    {
        finish(guesser);
        status = "Bad_UserAccessDenied";
    }
    work();
    fixture.server.handle_completions(fixture.now);
    std::erase_if(fixture.log.records,
                  [](const std::string& line) { return line.find("LoginRefused") != 0; });
    CHECK(fixture.log.records == std::vector<std::string>{"LoginRefused " + status +
                                                          " test/operator 192.0.2.1 "
                                                          "UserIdentityToken"});
}

TEST_CASE_METHOD(Working, "a client that is cut off again and again at a right login may log in")
{
    const bool is_looked_at = GENERATE(true, false);
    for (int i = 0; i < 12; ++i) {
        auto killed = fixture.connect(encrypt);
        REQUIRE(killed.create_session());
        static_cast<void>(send(killed, "operator-secret"));
        if (is_looked_at) {
            work();
        }
        killed.channel.close();
        killed.run();
        work();
        fixture.server.handle_completions(fixture.now);
    }
    CHECK(fixture.users.asked == (is_looked_at ? 12 : 0));
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    const auto sent = send(client, "operator-secret");
    finish(client);
    CHECK(client.take_activate(sent) == status::Good);
}

TEST_CASE_METHOD(Working, "who waits for checks is told when they end without a decision")
{
    auto first = fixture.connect(encrypt);
    REQUIRE(first.create_session());
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    std::vector<std::uint32_t> sent;
    for (int i = 0; i < 5; ++i) {
        sent.push_back(send(first, "operator-secret"));
    }
    const auto waiting = send(client, "operator-secret");
    REQUIRE(worker.jobs.size() == 5);
    SECTION("their nonce was used meanwhile")
    {
        fixture.users.used_worker = nullptr;
        REQUIRE(first.activate(first.user("maria", "maria-secret")) == status::Good);
        fixture.users.used_worker = &worker;
        finish(first);
        for (const auto request : sent) {
            CHECK(first.take_activate(request) == status::Bad_ApplicationSignatureInvalid);
        }
    }
    SECTION("their session is closed meanwhile")
    {
        REQUIRE(first.close_session() == status::Good);
        finish(first);
    }
    finish(client);
    CHECK(client.take_activate(waiting) == status::Good); // none of them was wrong
}

TEST_CASE_METHOD(Working, "logins that were right do not count as failures")
{
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    for (int i = 0; i < 30; ++i) {
        const auto sent = send(client, "operator-secret");
        finish(client);
        REQUIRE(client.take_activate(sent) == status::Good);
    }
    auto fresh = fixture.connect({}, client_identity(), "203.0.113.1");
    REQUIRE(fresh.create_session());
    const auto sent = send(fresh, "operator-secret");
    finish(fresh);
    CHECK(fresh.take_activate(sent) == status::Good); // the name is not slowed down
}

} // namespace activate_session_test
