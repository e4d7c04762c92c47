"""The report: one HTML file with pictures, tables and an interactive 3-D view, which needs no network.

``page`` says what a page is made of and writes it, ``scene`` makes the 3-D view of finished runs, ``surfaces`` finds
what shows of a body, ``packing`` makes numbers small. ``page.html`` and ``style.css`` are the page's frame, and in it
``surfaces.js`` and ``viewer.js`` draw the view.
"""
