/// The program that owns the precompiled header of all tests (tests/CMakeLists.txt).
int main()
{
    return 0;
}
