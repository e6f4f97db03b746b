// Carries the precompiled GoogleTest header for all test programs.
